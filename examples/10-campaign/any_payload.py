"""Claims that the arm carries any payload up to 1 kg.

Hypothesis finds the simplest world in which it does not.
"""

from __future__ import annotations

from contextlib import closing

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from worlds import Worlds

# The same search each time, and no limit of time for one world.
SETTINGS = settings(
    max_examples=60,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
)


def main() -> None:
    """Exits with an error that shows the world."""
    with closing(Worlds("heavy.xml")) as worlds:

        @SETTINGS
        @given(
            payload=st.decimals(0, 1, places=2),
            friction=st.decimals(0, "0.3", places=2),
        )
        def carries(payload: object, friction: object) -> None:
            answer = worlds.run(seed=1, payload=str(payload), friction=str(friction))
            assert answer["outcome"] == "passed", answer["reason"]

        carries()


if __name__ == "__main__":
    main()
