import os

import rtf


class FixtureValue(rtf.TestCase):
    def run(self):
        values = [self.fixture_value(f"simulator.{name}") for name in ("port", "model", "limits")]
        is_ready = self.fixture_value("simulator.ready")
        if values != [40123, "arm", [-1.5, 1.5]] or is_ready is not True:
            self.fail(f"wrong values: {values}, {is_ready}")
        if os.environ.get("RTF_FIXTURE_SIMULATOR_PORT") != "40123":
            self.fail("wrong port in the environment")
        self.report("values read")
