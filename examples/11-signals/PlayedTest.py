"""Takes the place of a test whose recording is played: only the monitors judge."""

from __future__ import annotations

import rtf

SECONDS = 1.5
"""As long as the motion that was recorded."""


class PlayedTest(rtf.TestCase):
    """Waits for the end of the recording."""

    def run(self) -> None:
        self.sleep(SECONDS)
