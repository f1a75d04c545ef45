"""A test that asks what its parameter names."""

from pathlib import Path

import rtf

# The smallest PNG: one grey pixel.
PNG = bytes.fromhex(
    "89504e470d0a1a0a0000000d49484452000000010000000108000000003a7e9b55"
    "0000000a49444154789c63680000008200817745ddb80000000049454e44ae426082"
)


class Asks(rtf.TestCase):
    """Reports its answers."""

    def setup(self, args: list[str]) -> None:
        """Read the parameter."""
        self.kind = args[0]

    def run(self) -> None:
        """Ask."""
        if self.kind == "choice":
            picture = Path("hand.png")
            picture.write_bytes(PNG)
            text = "Is the <b>hand</b>\nclosed?"
            self.report("it is " + self.ask(text, ["yes", "no"], 600, "no", picture))
        elif self.kind == "text":
            self.report("number " + self.ask("Serial number?", timeout=600))
        else:
            self.instruct("Push the button", timeout=600)
