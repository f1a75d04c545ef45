"""Says what time it is, ten times a second, until it is stopped."""

from __future__ import annotations

import time

import rtf


class Ticker(rtf.TestCase):
    """Whoever reads it knows how late he is."""

    def run(self) -> None:
        while True:
            self.report(f"tick {time.time():.6f}")
            self.sleep(0.1)
