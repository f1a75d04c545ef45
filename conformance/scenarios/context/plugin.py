import rtf


class Context(rtf.TestCase):
    def run(self):
        self.report(f"{self.name} {self.param} {self.environment} {self.repetition}")
