"""The arm of lesson 1 in a world with a payload and joint friction, faster than real time."""

from __future__ import annotations

import random
from dataclasses import dataclass

import lesson_1  # noqa: F401 - makes `simulator` known
import mujoco
from simulator import ARM, STEP_SECS

SETTLE_SECS = 3.0
"""How long the arm has to reach a pose, in simulated seconds."""

READINGS = 50
"""How many noisy readings of an encoder are averaged."""


@dataclass(frozen=True)
class Conditions:
    """What varies between two episodes."""

    payload: float
    """Kilograms in the hand."""
    friction: float
    """Newton metres of dry friction in each joint."""
    noise: float
    """The standard deviation of the encoders, in radians."""
    seed: int

    @classmethod
    def of(cls, variables: dict[str, str]) -> Conditions:
        """Reads the variables of an episode."""
        return cls(
            payload=float(variables.get("RTF_PARAM_PAYLOAD", "0.2")),
            friction=float(variables.get("RTF_PARAM_FRICTION", "0.1")),
            noise=float(variables.get("RTF_PARAM_NOISE", "0.001")),
            seed=int(variables.get("RTF_EPISODE_SEED", "0")),
        )


class World:
    """The physics. Each step is 2 ms of simulated time."""

    def __init__(self, conditions: Conditions) -> None:
        self.model = mujoco.MjModel.from_xml_string(ARM)
        self.data = mujoco.MjData(self.model)
        self.joints = [self.model.joint(index).name for index in range(self.model.njnt)]
        self._hand_mass = float(self.model.body("hand").mass[0])
        self.reset(conditions)

    def reset(self, conditions: Conditions) -> None:
        """Starts again, in a start pose that only the seed determines."""
        self.random = random.Random(conditions.seed)
        self.noise = conditions.noise
        self.model.body("hand").mass[0] = self._hand_mass + conditions.payload
        self.model.dof_frictionloss[:] = conditions.friction
        mujoco.mj_setConst(self.model, self.data)
        mujoco.mj_resetData(self.model, self.data)
        for index in range(self.model.nq):
            self.data.qpos[index] = self.random.uniform(-0.2, 0.2)
        mujoco.mj_forward(self.model, self.data)

    def carry(self, targets: list[float]) -> list[float]:
        """Moves all joints, and returns where they are according to their encoders, in radians."""
        self.data.ctrl[:] = targets
        mujoco.mj_step(self.model, self.data, nstep=round(SETTLE_SECS / STEP_SECS))
        return [self._encoder(joint) for joint in self.joints]

    def _encoder(self, joint: str) -> float:
        value = float(self.data.sensor(joint).data[0])
        noise = sum(self.random.gauss(0, self.noise) for _ in range(READINGS)) / READINGS
        return value + noise
