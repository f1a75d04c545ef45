import pathlib
import tempfile

import rtf


class Ask(rtf.TestCase):
    def run(self):
        with tempfile.TemporaryDirectory() as folder:
            picture = pathlib.Path(folder) / "hand.png"
            picture.write_bytes(b"\x89PNG\r\n\x1a\n")
            answer = self.ask("Is the hand\nclosed?", ["yes", "no"], 20, "no", picture)
        self.report("answer: " + answer)
        with self.case("serial number"):
            self.report("answer: " + self.ask("Serial number?", default="SN-17"))
        self.instruct("Push the button", timeout=1.5, default="done")
        self.report("pushed")
