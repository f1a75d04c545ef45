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

    def act(self, observations: Any) -> Any:
        """The same for all slots."""
        return np.tile(GOAL, (len(observations), 1))
