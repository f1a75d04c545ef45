"""Interface: each command answers as the simulator's first lines promise."""

from __future__ import annotations

import lesson_1  # noqa: F401 - makes arm_client known
import rtf
from arm_client import Arm


class CommandsTest(rtf.TestCase):
    """Asks each command, also for what it must refuse. Nothing moves."""

    arm: Arm | None = None

    def setup(self, _args: list[str]) -> None:
        self.arm = Arm()

    def run(self) -> None:
        arm = self.arm
        assert arm is not None
        self.check(arm.joints() == ["shoulder", "elbow", "wrist"], "three joints, base first")
        for joint in arm.joints():
            low, high = map(float, arm.ask(f"limits {joint}").split())
            self.check(low < arm.position(joint) < high, f"{joint} is within its limits")
            self.refuses(arm, f"set {joint} {high + 0.1}")
            self.refuses(arm, f"set {joint} nan")
        before = arm.time()
        self.sleep(0.05)
        self.check(arm.time() > before, "time goes on")
        self.refuses(arm, "get knee")
        self.refuses(arm, "dance")

    def refuses(self, arm: Arm, line: str) -> None:
        """The arm refuses a line, and still answers after it."""
        try:
            answer = arm.ask(line)
        except ConnectionError:
            raise
        except OSError as refused:
            self.report(f"refused: {refused}")
        else:
            self.fail(f"`{line}` must be refused, and was answered: ok {answer}")

    def tearDown(self) -> None:
        if self.arm is not None:
            self.arm.close()
