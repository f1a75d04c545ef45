"""One episode of the arm in its process, with `mujoco.rollout` or as an environment."""

import os

import rtf
from two_link_arm import GOAL, Rollouts, arm_env, passed


class ArmProcess(rtf.TestCase):
    """What a suite without slots does."""

    def setup(self, args: list[str]) -> None:
        """Chooses the simulator."""
        self.is_rollout = args == ["rollout"]

    def run(self) -> None:
        """The whole episode."""
        seed = int(os.environ["RTF_EPISODE_SEED"])
        if self.is_rollout:
            self.check(passed(Rollouts().run([seed])[1][0]), "near the goal")
            return
        env = arm_env()
        env.reset(seed=seed)
        is_over = False
        while not is_over:
            *_, is_over, info = env.step(GOAL)
        self.check(info["is_success"], "near the goal")
