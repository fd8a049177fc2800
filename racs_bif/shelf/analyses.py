"""The analyses on the shelf, as modules; `racs_bif.shelf.modules` finds them."""

__path__: list[str] = []  # a package: its modules are files elsewhere
