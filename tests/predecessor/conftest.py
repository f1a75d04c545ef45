"""An installed rtf, and the unpacked packages of its predecessor."""

from __future__ import annotations

from pathlib import Path

import pytest
from checkout import BUILD, ROOT, call, output_of


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory for a module."""
    return tmp_path_factory.mktemp("work")


@pytest.fixture(scope="module")
def prefix(rtf: str, work: Path) -> Path:
    """The directory of an installed rtf."""
    prefix = work / "prefix"
    places = {"PREFIX": prefix, "PROGRAMS": Path(rtf).parent, "LIBRARIES": BUILD}
    variables = {name: str(place) for name, place in places.items()}
    call("tools/install.sh", cwd=ROOT, DESTDIR="", **variables)
    return prefix


@pytest.fixture(scope="module")
def predecessor() -> Path:
    """The directory of Debian's robot-testing-framework 2.x."""
    return Path(output_of("tools/predecessor.sh")) / "usr"
