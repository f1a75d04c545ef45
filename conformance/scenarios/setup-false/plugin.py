import rtf


class SetupFalse(rtf.TestCase):
    def setup(self, args):
        return False

    def run(self):
        self.report("never")

    def tearDown(self):
        self.report("torn down")
