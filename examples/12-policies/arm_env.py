"""A two-link arm with torque-limited motors, which carries a payload to a target pose."""

from __future__ import annotations

from typing import Any

import gymnasium
import mujoco
import numpy as np
from numpy.typing import NDArray

ARM = """
<mujoco>
  <option timestep="0.005" integrator="implicitfast"/>
  <default>
    <joint axis="0 1 0" damping="0.2" armature="0.02"/>
    <geom type="capsule" size="0.03" contype="0" conaffinity="0"/>
    <motor ctrllimited="true" ctrlrange="-1 1"/>
  </default>
  <worldbody>
    <body>
      <joint name="shoulder"/>
      <geom fromto="0 0 0 0.4 0 0" mass="1"/>
      <body pos="0.4 0 0">
        <joint name="elbow"/>
        <geom fromto="0 0 0 0.3 0 0" mass="0.6"/>
        <body name="hand" pos="0.3 0 0"> <geom type="sphere" mass="0.1"/> </body>
      </body>
    </body>
  </worldbody>
  <actuator> <motor joint="shoulder" gear="20"/> <motor joint="elbow" gear="8"/> </actuator>
</mujoco>
"""
STEP_SECS = 0.02
"""The simulated time of a step: the rate of the controller is 50 Hz."""

TIME_SECS = 2.0
"""How long the arm has to reach the target."""

TOLERANCE = 0.03
"""How far the hand may be from the target, in metres."""

START = np.array([1.2, 0.4])
"""The middle of all start poses, in radians: the arm hangs down."""

SHOULDER = {"low": 0.6, "level": 0.0, "high": -0.6}
"""The angle of the shoulder at the middle of each kind of target, in radians."""

DEFAULTS = {"payload": "0.5", "friction": "0.1", "target": "level"}
"""The parameters of an episode without a campaign: kilograms, newton metres, a kind of target."""

Array = NDArray[np.float64]


class ArmEnv(gymnasium.Env[Array, Array]):
    """Observations: angles, speeds, target angles, payload. Actions: torques, from -1 to 1."""

    observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (7,), np.float64)
    action_space = gymnasium.spaces.Box(-1, 1, (2,), np.float64)

    def __init__(self) -> None:
        self.parameters: dict[str, str] = {}
        self.model = mujoco.MjModel.from_xml_string(ARM)
        self.data = mujoco.MjData(self.model)
        self._hand = self.model.body("hand").id
        self._hand_mass = float(self.model.body_mass[self._hand])

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """The seed determines the target and the start pose; the parameters are the episode's."""
        super().reset(seed=seed, options=options)
        chosen = DEFAULTS | self.parameters
        self.payload = float(chosen["payload"])
        self.model.body_mass[self._hand] = self._hand_mass + self.payload
        self.model.dof_frictionloss[:] = float(chosen["friction"])
        mujoco.mj_setConst(self.model, self.data)
        middle = [SHOULDER[chosen["target"]], 0.4]
        self.goal = self.np_random.uniform(-0.2, 0.2, 2) + middle
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = self.goal
        mujoco.mj_kinematics(self.model, self.data)
        self.target = self.data.xpos[self._hand].copy()
        self.data.qpos[:] = self.np_random.uniform(-0.2, 0.2, 2) + START
        mujoco.mj_forward(self.model, self.data)
        self.path = [self.data.qpos.copy()]
        return self._observation(), {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """The episode ends when the arm has reached its target, or when its time has passed."""
        self.data.ctrl[:] = action
        mujoco.mj_step(self.model, self.data, nstep=round(STEP_SECS / self.model.opt.timestep))
        self.path.append(self.data.qpos.copy())
        error = float(np.linalg.norm(self.data.xpos[self._hand] - self.target))
        is_success = error < TOLERANCE and bool(np.abs(self.data.qvel).max() < 0.2)
        is_over = len(self.path) > TIME_SECS / STEP_SECS
        info: dict[str, Any] = {"is_success": is_success, "error": error}
        if is_over and not is_success:
            info["path"] = self.path
        return self._observation(), -error, is_success, is_over, info

    def _observation(self) -> Array:
        return np.concatenate([self.data.qpos, self.data.qvel, self.goal, [self.payload]])
