"""A plug-in that knows rtf only as it is installed."""

import rtf


class PythonTest(rtf.TestCase):
    """Passes."""

    def run(self) -> None:
        self.check(self.environment == "--robot simulator", "the suite's environment arrives")
        self.check_angle_near(3.14159, -3.14159, 0.001, "an angle")
        self.measure("two", 2, "rad", low=1, high=3)
