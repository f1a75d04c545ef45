"""A test that does nothing."""

import rtf


class Trivial(rtf.TestCase):
    """Only the overhead is measured."""

    def run(self) -> None:
        """One check that holds."""
        self.check(True, "nothing is wrong")
