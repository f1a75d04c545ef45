import pathlib
import tempfile

import rtf


class Attach(rtf.TestCase):
    def run(self):
        with tempfile.TemporaryDirectory() as folder:
            trace = pathlib.Path(folder) / "trace.csv"
            trace.write_text("t,q\n0,1\n")
            self.attach(trace, "trace.csv", "text/csv")
