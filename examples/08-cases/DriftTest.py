"""A test with a known failure: rtf.toml quarantines it."""

from __future__ import annotations

import lesson_1  # noqa: F401 - makes arm_client known
import rtf
from arm_client import Arm


class DriftTest(rtf.TestCase):
    """The arm's clock should not advance while the arm rests, and does."""

    def run(self) -> None:
        arm = Arm(int(self.fixture_value("arm.port")))
        before = arm.time()
        self.sleep(0.2)
        self.check(arm.time() == before, "the clock stands still while the arm rests")
        arm.close()
