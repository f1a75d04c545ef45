"""The arm's episodes in a vector environment."""

from typing import Any

import numpy as np
import rtf.gymnasium
from two_link_arm import GOAL, TIMESTEP, arm_env


class ArmVector(rtf.gymnasium.VectorTest):
    """The policy is the goal."""

    timestep = TIMESTEP

    def make_env(self) -> Any:
        """One arm."""
        return arm_env()

    def setup(self, args: list[str]) -> None:  # noqa: ARG002 - not needed
        """The loop without rtf computes them once, too."""
        self.actions = np.tile(GOAL, (self.slots, 1))

    def act(self, observations: Any) -> Any:  # noqa: ARG002 - always the same
        """The same for all slots."""
        return self.actions
