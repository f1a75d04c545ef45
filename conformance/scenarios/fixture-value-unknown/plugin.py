import rtf


class FixtureValueUnknown(rtf.TestCase):
    def run(self):
        self.fixture_value("simulator.speed")
        self.report("never")

    def tearDown(self):
        self.report("torn down")
