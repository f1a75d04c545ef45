"""Services: the motor is switched off and on."""

from __future__ import annotations

from station import StationTest
from std_srvs.srv import SetBool


class ServiceTest(StationTest):
    """A joint without power stays where it is, and goes on when it has power again."""

    def run(self) -> None:
        self.check(self.switch(False).endswith(": off"), "the motor is off")
        before = self.position()
        self.go(before + 0.5)
        self.sleep(0.5)
        self.check_near(self.position(), before, 1e-6, "a joint without power")
        self.check(self.switch(True).endswith(": on"), "the motor is on")
        self.arrive(before + 0.2, timeout=20)
        self.arrive(0.0, timeout=20)

    def switch(self, on: bool) -> str:
        """Switch the motor, and return what it says."""
        answer = self.call(SetBool, "motor", SetBool.Request(data=on))
        self.require(answer.success, answer.message)
        return str(answer.message)
