"""The base class of tests whose episodes run in a vector environment."""

from __future__ import annotations

import os
from dataclasses import dataclass

from rtf._episode_test import EpisodeTest, current
from rtf._stop import Error

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    import gymnasium
    from gymnasium.vector import VectorEnv

    from rtf._episode import Episode
    from rtf.gymnasium.environments import SlotParameters


@dataclass(frozen=True)
class EpisodeEnd:
    """The end of an episode, as its environment reports it."""

    episode: Episode
    """The episode: `id`, `seed`, `parameters`."""
    info: dict[str, Any]
    """The environment's `info` of the last step."""
    reward: float
    """The sum of the rewards of all steps."""
    steps: int
    """How many steps it took, from 1."""
    terminated: bool
    """Whether it reached a state that ends the task."""
    truncated: bool
    """Whether the environment ended it otherwise, for example after a number of steps."""


class VectorTest(EpisodeTest):
    """A test that runs its episodes in a vector environment, one in each slot.

    Write `act`, and `make_env` or `make_envs`; and `judge`, unless the environment reports
    `is_success` or `success` in its `info`. `setup` may load the policy.
    """

    timestep: float | None = None
    """The simulated time of a step, in s, above 0. `max-time` of the suite needs it."""

    asynchronous: bool = False
    """Whether the environments of `make_env` run in a forked process each."""

    _parameters: SlotParameters | None = None

    def make_env(self) -> gymnasium.Env[Any, Any]:
        """Create one environment. It is called for each slot."""
        name = type(self).__name__
        raise Error(f"{name} has neither `make_env(self)` nor `make_envs(self, slots)`")

    def make_envs(self, slots: int) -> VectorEnv[Any, Any, Any]:
        """Create a vector environment with so many slots, and with `AutoresetMode.DISABLED`.

        The default is one of `make_env`, in which an exception ends only its own episode.
        """
        from rtf.gymnasium import environments  # noqa: PLC0415 - needs Gymnasium

        # `rtf campaign invariance` compares both modes.
        is_other = os.environ.get("RTF_VECTOR_MODE") == "other"
        return environments.make(self.make_env, slots, asynchronous=self.asynchronous != is_other)

    def act(self, observations: Any) -> Any:
        """Return the actions of all slots.

        `observations` are those of all slots, in the form of `envs.observation_space`: for a
        `Box` of the shape S, an array of the shape (slots, *S). The actions have the form of
        `envs.action_space`. Slots without an episode have an observation, and need an action.
        """
        raise NotImplementedError(f"{type(self).__name__} has no `act(self, observations)`")

    def judge(self, end: EpisodeEnd) -> bool | str:
        """Return whether an episode passed; a text is the reason why it failed.

        Checks and measurements in it belong to the episode.
        """
        for name in ("is_success", "success"):
            if name in end.info:
                return bool(end.info[name])
        names = ", ".join(f"`{name}`" for name in end.info) or "nothing"
        raise Error(
            "the environment reports neither `is_success` nor `success` in the `info` of the last"
            f" step, but {names}: write `judge(self, end)`"
        )

    def configure(self, envs: VectorEnv[Any, Any, Any], slot: int, episode: Episode) -> None:
        """Give a slot, from 0, the parameters of its episode, before it is reset.

        The default sets the attribute `parameters` of its environment, a dictionary of texts, if
        the environment has one. In a vector environment of `make_envs`, it calls `set_attr`,
        which sets the attribute of all slots: that of the others to the value that they have.
        """
        if self._parameters is not None:
            self._parameters.set(slot, episode.parameters)

    def run(self) -> None:
        """Run all episodes."""
        try:
            import gymnasium  # noqa: F401, PLC0415 - only when it is needed
            import numpy as np  # noqa: F401, PLC0415
        except ModuleNotFoundError as problem:
            if problem.name not in {"gymnasium", "numpy"}:
                raise
            name = problem.name
            text = f"`rtf.gymnasium` needs the module `{name}`: pip install gymnasium"
            raise Error(text) from None
        from rtf.gymnasium import environments, loop, slots  # noqa: PLC0415

        envs = self.make_envs(self.slots)
        try:
            environments.check(envs, self.slots)
            self._parameters = environments.SlotParameters(envs)
            loop.Loop(self, slots.Slots(envs, self._parameters), current()).run()
        except BaseException:
            environments.close_after_problem(envs)
            raise
        envs.close()
