import rtf


class AskInTearDown(rtf.TestCase):
    def run(self):
        self.report("running")

    def tearDown(self):
        self.ask("Is the hand closed?", default="no")
        self.report("not reached")
