#!/usr/bin/env python3
"""A simulator that prints, and can be killed on its first start."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

KILL = Path(os.environ["PAGE_TEST_DIR"]) / "kill.go"


def main() -> None:
    """Runs until it is stopped."""
    print("loading \x1b[1mscene.xml\x1b[0m")
    start = int(os.environ["RTF_FIXTURE_START"])
    print(f"listening on port {40000 + start}")
    print("the simulator is up")
    step = 0
    while True:
        step += 1
        print(f"\x1b[33mstep\x1b[0m {step}")
        if start == 1 and KILL.exists():
            os.kill(os.getpid(), signal.SIGKILL)
        time.sleep(0.05)


if __name__ == "__main__":
    main()
