"""The arm's episodes with `mujoco.rollout`, in batches of the free slots."""

import rtf
from two_link_arm import STEPS, TIMESTEP, Rollouts, passed


class ArmRollouts(rtf.EpisodeTest):
    """Takes as many episodes as it gets."""

    def run(self) -> None:
        """Each batch is a call of the simulator."""
        rollouts = Rollouts()
        while episodes := self.take():
            starts, ends = rollouts.run([episode.seed for episode in episodes])
            for episode, start, end in zip(episodes, starts, ends, strict=True):
                with episode:
                    episode.finish(
                        passed(end), steps=STEPS, time=STEPS * TIMESTEP, first_observation=start
                    )
