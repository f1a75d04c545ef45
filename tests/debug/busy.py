"""A test that does not end by itself."""

import time

import rtf


class Busy(rtf.TestCase):
    """Turns."""

    def run(self) -> None:
        """Stop in the debugger, then turn."""
        turns = 0
        breakpoint()
        print("turning")
        while True:
            turns += 1
            time.sleep(0.01)
