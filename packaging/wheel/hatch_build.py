"""Adds the installed files to the wheel, and the platform to its name.

pip copies the wheel's data directory into the environment's prefix, so that `bin`, `libexec`,
`share`, `include` and `lib` have the layout of `make install`, which `rtf` expects.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class InstalledFiles(BuildHookInterface[Any]):
    """The files below `prefix`."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add them. `WHEEL_PLATFORM` is the platform tag, as `linux_x86_64`."""
        del version
        prefix = Path(self.root) / "prefix"
        for file in sorted(prefix.rglob("*")):
            name = file.relative_to(prefix)
            if file.is_symlink() or not file.is_file():
                continue
            if name.parts[0] == "bin":
                build_data["shared_scripts"][str(file)] = file.name
            else:
                build_data["shared_data"][str(file)] = str(name)
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{os.environ['WHEEL_PLATFORM']}"
