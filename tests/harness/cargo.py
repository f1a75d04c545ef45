"""Example programs of the Rust crates."""

from __future__ import annotations

import pytest
from checkout import TARGET, call


def example(config: pytest.Config, name: str) -> str:
    """The path of an example, which is built first, with the features of the whole workspace."""
    if not config.getoption("no_build"):
        call("cargo", "build", "--quiet", "--locked", "--workspace", "--example", name)
    return str(TARGET / "debug/examples" / name)
