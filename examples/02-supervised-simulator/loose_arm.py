#!/usr/bin/env python3
"""The arm of lesson 1 with a loose cable.

Its first start in a suite dies like a driver that loses its bus: without a
word, four seconds after it came up. `rtf` says in RTF_FIXTURE_START which
start it is.
"""

from __future__ import annotations

import os
import runpy
import signal
import threading

import lesson_1

DIES_AFTER_SECS = 4.0


def main() -> None:
    """Runs the simulator, on the first start with a bomb in it."""
    if os.environ.get("RTF_FIXTURE_START") == "1":
        bomb = threading.Timer(DIES_AFTER_SECS, os.kill, (os.getpid(), signal.SIGKILL))
        bomb.daemon = True
        bomb.start()
    runpy.run_path(str(lesson_1.FOLDER / "simulator.py"), run_name="__main__")


if __name__ == "__main__":
    main()
