import rtf


class ForeignException(rtf.TestCase):
    def run(self):
        raise ValueError("42")
