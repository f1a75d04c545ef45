"""Reports the time ten times per second until it is stopped."""

from __future__ import annotations

import time

import rtf


class Ticker(rtf.TestCase):
    """The page's delay is the difference to the reported time."""

    def run(self) -> None:
        while True:
            self.report(f"tick {time.time():.6f}")
            self.sleep(0.1)
