"""Delays the following tests until a file exists."""

from __future__ import annotations

from pathlib import Path

import rtf


class Gate(rtf.TestCase):
    """Waits for the file in the parameter."""

    def run(self) -> None:
        self.wait_until(Path(self.param).exists, 60, "the gate to open")
