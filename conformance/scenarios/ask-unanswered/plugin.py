import rtf


class AskUnanswered(rtf.TestCase):
    def run(self):
        self.ask("Is the hand closed?", ["yes", "no"])
        self.report("not reached")

    def tearDown(self):
        self.report("torn down")
