"""Files that were given by their path, as modules; `racs_bif.shelf.modules` finds them."""

__path__: list[str] = []  # a package: its modules are files elsewhere
