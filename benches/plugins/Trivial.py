"""A test that does nothing."""

import rtf


class Trivial(rtf.TestCase):
    """What is left is the price of running it."""

    def run(self) -> None:
        """Holds."""
        self.check(True, "nothing is wrong")
