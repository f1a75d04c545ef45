"""The pytest fixture `rtf`: results of a test, reported while it runs."""

from __future__ import annotations

import pytest

from rtf import session


@pytest.fixture
def rtf() -> session.Session:
    """Report measurements, samples, files and texts to `rtf`; without it, do nothing."""
    return session.current()
