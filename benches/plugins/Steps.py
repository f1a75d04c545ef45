"""A typical test: it takes 20 ms, mostly waiting, and reports a few messages."""

from __future__ import annotations

import rtf


class Steps(rtf.TestCase):
    """Five steps of 4 ms."""

    def run(self) -> None:
        for step in range(5):
            self.sleep(0.004)
            self.measure("step", step, "", 0, 5)
