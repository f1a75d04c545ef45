import sys

import rtf


class ExitZero(rtf.TestCase):
    def run(self):
        self.check(False, "already wrong")
        sys.exit(0)
