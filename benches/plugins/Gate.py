"""Holds the tests after it back until a file is there."""

from __future__ import annotations

from pathlib import Path

import rtf


class Gate(rtf.TestCase):
    """Opens when the file that the parameter names is there."""

    def run(self) -> None:
        self.wait_until(Path(self.param).exists, 60, "the gate to open")
