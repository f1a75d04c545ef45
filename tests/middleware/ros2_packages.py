"""Packages of messages that differ from the installed ones."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from checkout import venv

CHANGED = "RIHS01_" + "0" * 64


def shadow(directory: Path, *, is_known: bool) -> Path:
    """A package of messages in place of the installed one: empty, or with another definition."""
    directory.mkdir()
    package = directory / "lifecycle_msgs"
    if not is_known:
        package.mkdir()
        (package / "__init__.py").touch()
        return directory
    prefix = venv("ros2").parent
    (installed,) = prefix.glob("lib/python3*/site-packages/lifecycle_msgs")
    package.symlink_to(installed)
    definition = directory / "share/lifecycle_msgs/msg/State.json"
    shutil.copytree(prefix / "share/lifecycle_msgs/msg", definition.parent)
    description = json.loads(definition.read_text())
    for each in description["type_hashes"]:
        each["hash_string"] = CHANGED
    definition.write_text(json.dumps(description))
    return directory
