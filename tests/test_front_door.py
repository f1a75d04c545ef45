"""What a new user meets first: the bootstrap on a new machine, and the user's guide."""

from __future__ import annotations

import pytest
from checkout import call


@pytest.mark.first
def test_bootstrap_in_a_minimal_debian() -> None:
    call("tools/front_door.sh")


def test_guide_is_built(rtf: str) -> None:
    """Without warnings, broken links or missing terms."""
    call("tools/docs.sh", rtf)
