"""A plug-in whose test must fail, so that a runner that passes everything is noticed."""

import rtf


class FailingTest(rtf.TestCase):
    """Fails."""

    def run(self) -> None:
        self.check_near([0.0, 1.0], [0.0, 1.5], 0.1, "joint positions")
