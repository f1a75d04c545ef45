"""Drives for two seconds."""

from __future__ import annotations

import rtf


class DriveTest(rtf.TestCase):
    """Monitors judge what happens."""

    def run(self) -> None:
        """Drive."""
        self.sleep(2)
