"""Episodes in vector environments of Gymnasium.

A test is a class with an environment and a policy, and often with a judgement::

    import gymnasium
    import rtf.gymnasium

    class Reach(rtf.gymnasium.VectorTest):
        def make_env(self):
            return gymnasium.make("Reacher-v5")

        def act(self, observations):
            return policy(observations)

        def judge(self, end):
            return end.reward > -12 or f"the reward is {end.reward:.1f}"

Gymnasium and numpy are imported when the test runs.
"""

from rtf.gymnasium.vector_test import EpisodeEnd, VectorTest

__all__ = ["EpisodeEnd", "VectorTest"]
