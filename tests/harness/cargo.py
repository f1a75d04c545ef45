"""Example programs of the Rust crates."""

from __future__ import annotations

import pytest
from checkout import TARGET, call


def example(config: pytest.Config, package: str, name: str) -> str:
    """The path of an example, which is built first."""
    if not config.getoption("no_build"):
        call("cargo", "build", "--quiet", "--locked", "-p", package, "--example", name)
    return str(TARGET / "debug/examples" / name)
