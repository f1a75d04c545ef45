import rtf


class FaultUndeclared(rtf.TestCase):
    def run(self):
        self.fault("drop")
        self.report("not reached")
