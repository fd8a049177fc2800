"""The shelf: models and analyses, one file each, found by name in every kind of installation."""

from racs_bif.shelf.folders import find, folders, names
from racs_bif.shelf.modules import complaint, load_module

__all__ = ["complaint", "find", "folders", "load_module", "names"]
