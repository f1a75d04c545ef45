"""An environment whose exceptions and mistakes end only its own episode."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np

from rtf import _exceptions, _session

if TYPE_CHECKING:
    from rtf.gymnasium.environments import Parameters

ERROR = "rtf_error"
"""The name in `info` of what is wrong: the text, and the file and line if they are known."""

Step = tuple[Any, float, bool, bool, dict[str, Any]]

_STEP = ("observation", "reward", "terminated", "truncated", "info")


class GuardedEnv(gymnasium.Wrapper):  # type: ignore[misc, type-arg, unused-ignore]
    """Reports an exception in `info`, and does nothing more until the next reset."""

    def __init__(self, env: gymnasium.Env[Any, Any], slot: int) -> None:
        """Guard the environment of a slot, from 0."""
        super().__init__(env)
        self._slot = slot
        self._parameters: dict[str, str] | None = None
        self._has_failed = False
        # Properties of a wrapper ask all environments in it; a step must cost next to nothing.
        self._shape = self.observation_space.shape
        # Stands for the observations after an exception, which are ignored.
        self.observation_space.seed(0)
        self._blank = self.observation_space.sample()

    def set_episode_parameters(self, by_slot: Parameters) -> None:
        """Set the attribute `parameters` at the next reset, if it is that of this slot."""
        self._parameters = by_slot.get(self._slot, self._parameters)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Reset the environment."""
        self._has_failed = False
        try:
            if self._parameters is not None:
                self.env.set_wrapper_attr("parameters", self._parameters)
                self._parameters = None
            result = self.env.reset(seed=seed, options=options or None)
            observation, info = _checked(result, "reset", ("observation", "info"))
            self._check_shape(observation, "reset")
        except Exception as problem:  # noqa: BLE001 - that of the environment
            return self._blank, self._failed(problem)
        return observation, info

    def step(self, action: Any) -> Step:
        """Step the environment."""
        if self._has_failed:
            return self._blank, 0.0, False, False, {}
        try:
            result = self.env.step(action)
            if type(result) is not tuple or len(result) != len(_STEP):
                result = _checked(result, "step", _STEP)
            observation, reward, terminated, truncated, info = result
            if getattr(observation, "shape", None) != self._shape:
                self._check_shape(observation, "step")
            return observation, float(reward), bool(terminated), bool(truncated), info
        except Exception as problem:  # noqa: BLE001 - that of the environment
            return self._blank, 0.0, False, False, self._failed(problem)

    def _check_shape(self, observation: Any, function: str) -> None:
        shape = self._shape
        got = np.shape(observation) if shape is not None else None
        if got != shape:
            text = f"`{function}` returned an observation of the shape {got}, expected {shape}"
            raise ValueError(text)

    def _failed(self, problem: Exception) -> dict[str, Any]:
        self._has_failed = True
        session = _session.running()
        file = "" if session is None else session.task.file
        # A list, because arrays of `info` hold numbers or objects.
        return {ERROR: list(_exceptions.described(problem, file))}


def _checked(result: Any, function: str, names: tuple[str, ...]) -> Any:
    if isinstance(result, tuple) and len(result) == len(names):
        return result
    got = f"{len(result)} results" if isinstance(result, tuple) else type(result).__name__
    raise ValueError(f"`{function}` returned {got}, expected {len(names)}: {', '.join(names)}")
