"""Tests that ask an operator."""

from pathlib import Path

import rtf

# Without a picture library: the smallest PNG, one grey pixel.
PNG = bytes.fromhex(
    "89504e470d0a1a0a0000000d4948445200000001000000010800000000"
    "3a7e9b550000000a49444154789c63680000008200817745ddb80000000049454e44ae426082"
)


class Questions(rtf.TestCase):
    """Asks what its parameter names, and reports the answers."""

    def setup(self, args: list[str]) -> None:
        """Read the parameter."""
        self.kind = args[0]

    def run(self) -> None:
        """Ask."""
        getattr(self, self.kind)()

    def choice(self) -> None:
        """Choose one of two; the text would clear the screen."""
        self.report("answer: " + self.ask("Is it \x1b[2Jclosed?", ["yes", "no"], 60))

    def text(self) -> None:
        """Type a text."""
        self.report("answer: " + self.ask("Serial number?", timeout=60))

    def instruction(self) -> None:
        """Follow an instruction with a picture."""
        picture = Path("button.png")
        picture.write_bytes(PNG)
        self.instruct("Push the button", picture, timeout=60)

    def default(self) -> None:
        """Let the time pass."""
        self.report("answer: " + self.ask("Is anybody here?", ["yes", "no"], 0.5, "no"))

    def two(self) -> None:
        """Ask a question that ends by itself, then another one."""
        self.ask("First?", ["yes", "no"], 1, "no")
        self.report("answer: " + self.ask("Second?", ["yes", "no"], 60))

    def forever(self) -> None:
        """Wait for an answer."""
        try:
            self.ask("Does it work?", ["yes", "no"], 3600)
        finally:
            print("the answer is no longer awaited")

    def tearDown(self) -> None:
        """Print that it was called."""
        print("torn down")
