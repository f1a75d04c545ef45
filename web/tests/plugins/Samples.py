"""Samples two signals."""

from __future__ import annotations

import math

import rtf


class Samples(rtf.TestCase):
    """2000 samples of each, 5 ms apart."""

    def run(self) -> None:
        for step in range(2000):
            at = step * 0.005
            self.sample("sine", math.sin(at), "rad", low=-2, high=2, time=at)
            self.sample("ramp", step / 100, "N", time=at)
