import os

import rtf


class Abort(rtf.TestCase):
    def run(self):
        self.report("before the abort")
        os.abort()
