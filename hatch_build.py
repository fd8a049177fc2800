"""Build hook: a wheel carries the folders ``models/`` and ``analyses/`` inside the package."""

from __future__ import annotations

from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class ShelfHook(BuildHookInterface[Any]):
    """Put the two folders under ``racs_bif/``; an editable install reads them where they are."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the folders to a standard wheel."""
        if version == "standard":
            for folder in ("models", "analyses"):
                build_data["force_include"][folder] = f"racs_bif/_{folder}"
