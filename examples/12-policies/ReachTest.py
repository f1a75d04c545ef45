"""The arm reaches a target with its payload, under the control of a policy."""

from __future__ import annotations

import rtf.gymnasium
from arm_env import STEP_SECS, TIME_SECS, ArmEnv
from controllers import CONTROLLERS, Array


class ReachTest(rtf.gymnasium.VectorTest):
    """Measures how far the hand is from the target; after a failure, samples the way of the arm."""

    timestep = STEP_SECS

    def setup(self, args: list[str]) -> None:
        self.controller = CONTROLLERS[args[-1]]()

    def make_env(self) -> ArmEnv:
        return ArmEnv()

    def act(self, observations: Array) -> Array:
        return self.controller(observations)

    def judge(self, end: rtf.gymnasium.EpisodeEnd) -> bool | str:
        self.measure("error", end.info["error"], "m")
        for step, (shoulder, elbow) in enumerate(end.info.get("path", [])):
            self.sample("shoulder", shoulder, "rad", time=step * STEP_SECS)
            self.sample("elbow", elbow, "rad", time=step * STEP_SECS)
        distance = f"{end.info['error'] * 100:.0f} cm from the target after {TIME_SECS:g} s"
        return end.info["is_success"] or distance
