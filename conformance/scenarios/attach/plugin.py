import pathlib
import tempfile

import rtf


class Attach(rtf.TestCase):
    def run(self):
        trace = pathlib.Path(tempfile.mkdtemp()) / "trace.csv"
        trace.write_text("t,q\n0,1\n")
        self.attach(trace, "trace.csv", "text/csv")
