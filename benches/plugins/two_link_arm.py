"""An arm with two links, which holds a pose for 500 steps: for bare loops and for rtf.

two_link_arm.py rollout|vector EPISODES SLOTS     runs the episodes without rtf
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np
from mujoco.rollout import Rollout

ARM = """
<mujoco>
  <option timestep="0.002"/>
  <default> <joint axis="0 1 0" damping="0.5"/> <position kp="40"/>
    <geom contype="0" conaffinity="0"/> </default>
  <worldbody> <body>
    <joint name="shoulder"/> <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.03"/>
    <body pos="0.4 0 0">
      <joint name="elbow"/> <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03"/>
    </body>
  </body> </worldbody>
  <actuator> <position joint="shoulder"/> <position joint="elbow"/> </actuator>
</mujoco>
"""
STEPS = 500
TIMESTEP = 0.002
GOAL = np.array([0.3, -0.3])


def pose(seed: int) -> Any:
    """The angles at the start, in radians."""
    return np.random.default_rng(seed).uniform(-1, 1, 2)


class Rollouts:
    """Batches of whole episodes, on all processors that this process may use."""

    def __init__(self) -> None:
        self._model = mujoco.MjModel.from_xml_string(ARM)
        count = len(os.sched_getaffinity(0))
        self._threads = [mujoco.MjData(self._model) for _ in range(count)]
        self._pool = Rollout(nthread=count)

    def run(self, seeds: list[int]) -> tuple[Any, Any]:
        """The first and the last state of each episode: time, angles, speeds."""
        starts = np.array([[0, *pose(seed), 0, 0] for seed in seeds])
        controls = np.broadcast_to(GOAL, (len(seeds), STEPS, 2))
        states, _ = self._pool.rollout(self._model, self._threads, starts, controls)
        return starts, states[:, -1]


def passed(state: Any) -> bool:
    """Whether a state is near the goal: it always is."""
    return bool(np.abs(state[1:3] - GOAL).max() < 1)


def arm_env() -> Any:
    """The same arm as an environment. It is a function, because Gymnasium takes long to import."""
    import gymnasium  # noqa: PLC0415

    class ArmEnv(gymnasium.Env):  # type: ignore[misc]
        """Actions are the goals of the servos."""

        observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (4,), np.float64)
        action_space = gymnasium.spaces.Box(-np.inf, np.inf, (2,), np.float64)

        def __init__(self) -> None:
            self.model = mujoco.MjModel.from_xml_string(ARM)
            self.data = mujoco.MjData(self.model)

        def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, Any]:
            """Starts an episode."""
            super().reset(seed=seed, options=options)
            mujoco.mj_resetData(self.model, self.data)
            self.data.qpos[:] = pose(seed or 0)
            self.steps = 0
            return np.concatenate([self.data.qpos, self.data.qvel]), {}

        def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
            """One step of the physics."""
            self.data.ctrl[:] = action
            mujoco.mj_step(self.model, self.data)
            self.steps += 1
            observation = np.concatenate([self.data.qpos, self.data.qvel])
            info = {"is_success": passed([0, *self.data.qpos])} if self.steps == STEPS else {}
            return observation, 0.0, False, self.steps == STEPS, info

    return ArmEnv()


def batches(episodes: int, slots: int) -> Iterator[list[int]]:
    """The seeds of each batch."""
    for first in range(0, episodes, slots):
        yield list(range(first, min(first + slots, episodes)))


def bare_rollout(episodes: int, slots: int) -> int:
    """How many episodes pass."""
    rollouts = Rollouts()
    ends = [rollouts.run(seeds)[1] for seeds in batches(episodes, slots)]
    return sum(passed(state) for states in ends for state in states)


def bare_vector(episodes: int, slots: int) -> int:
    """The same, in a vector environment."""
    from gymnasium import vector  # noqa: PLC0415

    mode = vector.AutoresetMode.DISABLED
    envs = vector.SyncVectorEnv([arm_env] * slots, autoreset_mode=mode)
    count = 0
    actions = np.tile(GOAL, (slots, 1))
    for seeds in batches(episodes, slots):
        # The last batch has fewer episodes: the other slots repeat one.
        envs.reset(seed=seeds + [seeds[0]] * (slots - len(seeds)))
        for _ in range(STEPS):
            *_, infos = envs.step(actions)
        count += int(infos["is_success"][: len(seeds)].sum())
    return count


if __name__ == "__main__":
    loop = {"rollout": bare_rollout, "vector": bare_vector}[sys.argv[1]]
    print(loop(int(sys.argv[2]), int(sys.argv[3])), "passed")
