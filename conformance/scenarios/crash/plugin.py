import ctypes

import rtf


class Crash(rtf.TestCase):
    def run(self):
        self.report("before the crash")
        ctypes.string_at(0)
