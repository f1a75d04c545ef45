"""Ends with the result that its parameter names."""

from __future__ import annotations

import os
import signal

import rtf


class Ends(rtf.TestCase):
    """`fail`, `error` or `crash`."""

    def setup(self, args: list[str]) -> None:
        self.how = args[0]

    def run(self) -> None:
        self.measure("rate", 87.5, "Hz", low=95, high=105)
        if self.how == "fail":
            self.check_near(1.5, 0.8, 0.1, "elbow")
        elif self.how == "error":
            raise OSError("no such device: /dev/ttyUSB0")
        else:
            os.kill(os.getpid(), signal.SIGSEGV)
