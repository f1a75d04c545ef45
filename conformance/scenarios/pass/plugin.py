import rtf


class Pass(rtf.TestCase):
    def run(self):
        self.report("hello")
        self.check(True, "one is one")

    def tearDown(self):
        self.report("torn down")
