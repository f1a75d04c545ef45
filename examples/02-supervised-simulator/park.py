#!/usr/bin/env python3
"""The hook: brings the arm to rest, and says whether it is there.

Exit code 0 means that the arm is safe. `rtf` tells in the environment why it
calls: RTF_HOOK_TRIGGER, RTF_HOOK_REASON, RTF_HOOK_TEST.
"""

from __future__ import annotations

import os
import sys
import time

import lesson_1  # noqa: F401 - makes arm_client known
from arm_client import Arm

REST_RAD = 0.0
NEAR_RAD = 0.05
LIMIT_SECS = 10.0


def park(arm: Arm) -> dict[str, float]:
    """Moves each joint to its rest; where the joints are when that is done."""
    joints = arm.joints()
    for joint in joints:
        arm.move(joint, REST_RAD)
    end = time.monotonic() + LIMIT_SECS
    while True:
        positions = {joint: arm.position(joint) for joint in joints}
        if all(abs(position - REST_RAD) <= NEAR_RAD for position in positions.values()):
            return positions
        if time.monotonic() > end:
            sys.exit(f"park: after {LIMIT_SECS:.0f} s the arm is still at {positions}")
        time.sleep(0.02)


def main() -> int:
    """Parks, or says why there is nothing to park."""
    print("called on", os.environ.get("RTF_HOOK_TRIGGER", "demand"))
    try:
        arm = Arm()
    except ConnectionRefusedError:
        print("the arm has no power: its brakes hold it")
        return 0
    print("parked:", {joint: round(position, 3) for joint, position in park(arm).items()})
    return 0


if __name__ == "__main__":
    sys.exit(main())
