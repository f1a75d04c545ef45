import rtf


class Critical(rtf.TestCase):
    def run(self):
        self.require_critical(False, "the emergency stop is pressed")
