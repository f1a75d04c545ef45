"""A test as they are: it takes 20 ms, nearly all of them waiting, and reports some things."""

from __future__ import annotations

import rtf


class Steps(rtf.TestCase):
    """Five steps of 4 ms."""

    def run(self) -> None:
        for step in range(5):
            self.sleep(0.004)
            self.measure("step", step, "", 0, 5)
