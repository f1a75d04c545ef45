"""A test with a breakpoint."""

import rtf


class Reach(rtf.TestCase):
    """Reaches for something."""

    def run(self) -> None:
        """Stop in the debugger."""
        angle = 42
        breakpoint()
        print("the angle is", angle)
        self.check(angle == 42, "the angle")
