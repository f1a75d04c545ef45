"""The ways to install rtf: a directory, a wheel, and Debian packages."""

from __future__ import annotations

import pytest
from checkout import call


@pytest.mark.first
@pytest.mark.usefixtures("rtf")
@pytest.mark.parametrize("script", ["install/run.sh", "wheel/run.sh", "install/deb.sh"])
def test_installed(script: str) -> None:
    call(f"tests/{script}")
