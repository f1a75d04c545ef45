"""Is this the only robot here? Another one's messages would make every other test worthless."""

from __future__ import annotations

from station import StationTest


class AloneTest(StationTest):
    """Listens for `param` seconds who else tells anything."""

    def run(self) -> None:
        self.sleep(float(self.param))
        others = self.robots - {self.environment}
        self.require(not others, f"no other robot is heard; heard: {sorted(self.robots)}")
