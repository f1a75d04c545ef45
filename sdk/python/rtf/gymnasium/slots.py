"""The slots of a vector environment, and checks of everything that it returns."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from rtf import _digest
from rtf._stop import Error
from rtf.gymnasium import batches

if TYPE_CHECKING:
    from collections.abc import Iterable

    from gymnasium.vector import VectorEnv
    from numpy.typing import NDArray

    from rtf.gymnasium.environments import SlotParameters

# The name in `info` of what went wrong in a guarded environment.
_ERROR = "rtf_error"

_RESET = ("observations", "infos")
_STEP = ("observations", "rewards", "terminated", "truncated", "infos")


class Slots:
    """The slots, which all take a step at the same time."""

    def __init__(self, envs: VectorEnv[Any, Any, Any], parameters: SlotParameters) -> None:
        """Start with slots that must be reset."""
        self.envs = envs
        self.parameters = parameters
        self.count: int = envs.num_envs
        self.observations: Any = None
        self.infos: dict[str, Any] = {}
        # Arrays with a number for each slot. `done`: it must be reset before the next step.
        self.done: NDArray[np.bool_] = np.ones(self.count, np.bool_)
        self.terminated = np.zeros(self.count, np.bool_)
        self.truncated = np.zeros(self.count, np.bool_)
        self.steps = np.zeros(self.count, np.int64)
        self.rewards = np.zeros(self.count)
        self._name = type(envs).__name__
        self._is_mask_verified = False

    def reset(self, seeds: dict[int, int]) -> None:
        """Reset slots, from 0, with their seeds."""
        mask = np.zeros(self.count, np.bool_)
        mask[list(seeds)] = True
        in_order = [seeds.get(slot) for slot in range(self.count)]
        self.parameters.apply()
        result: Any = self.envs.reset(seed=in_order, options={"reset_mask": mask})  # type: ignore[arg-type, unused-ignore]
        self.observations, self.infos = self._checked("reset", result, _RESET)
        self._check_observations("reset")
        self.done[mask] = False
        self.steps[mask] = 0
        self.rewards[mask] = 0

    def step(self, actions: Any) -> None:
        """Make a step in each slot."""
        result: Any = self.envs.step(actions)
        self.observations, *arrays, self.infos = self._checked("step", result, _STEP)
        for name, array in zip(_STEP[1:], arrays):
            if np.shape(array) != (self.count,):
                got = f"`step` of `{self._name}` returned {name} of the shape {np.shape(array)}"
                raise Error(f"{got}, expected ({self.count},)")
        self._check_observations("step")
        rewards, self.terminated, self.truncated = arrays
        self.rewards += rewards
        self.steps += 1
        self.done = np.logical_or(self.terminated, self.truncated)

    def check_actions(self, actions: Any) -> None:
        """Raise an error if they do not have a row for each slot."""
        problem = batches.shape_problem(self.envs.action_space, actions, "actions")
        if problem is not None:
            raise Error(f"`act` returned {problem}")

    def observation(self, slot: int) -> Any:
        """Return the present observation of a slot."""
        return batches.row(self.envs.single_observation_space, self.observations, slot)

    def hashes(self, slots: Iterable[int]) -> dict[int, str]:
        """Return the hashes of the present observations of slots."""
        return {slot: _digest.of(self.observation(slot)) for slot in slots}

    def may_have_ended(self, last_step: float) -> bool:
        """Whether any slot is done, has a problem, or has taken so many steps."""
        return bool(
            self.done.any()
            or self.steps.max() >= last_step
            or math.isnan(self.rewards.sum())
            or _ERROR in self.infos
            or self._may_have_nan()
        )

    def _may_have_nan(self) -> bool:
        if isinstance(self.observations, np.ndarray):
            # Faster than the precise answer, and NaN also for infinities of both signs.
            return self.observations.dtype.kind == "f" and math.isnan(self.observations.sum())
        return bool(self.has_nan().any())

    def has_nan(self) -> NDArray[np.bool_]:
        """Return which present observations contain a NaN: an array of the shape (slots,)."""
        return batches.rows_with_nan(
            self.envs.single_observation_space, self.observations, self.count
        )

    def errors(self) -> dict[int, Any]:
        """Return text and place of what went wrong in guarded environments, by the slots."""
        if _ERROR not in self.infos:
            return {}
        failed = np.flatnonzero(self.infos[f"_{_ERROR}"])
        return {int(slot): self.infos[_ERROR][slot] for slot in failed}

    def reset_some(self, seeds: dict[int, int], others: list[int]) -> None:
        """Reset slots. The first time, check that the others keep their observations."""
        if self._is_mask_verified or not others:
            self.reset(seeds)
            return
        before = self.hashes(others)
        self.reset(seeds)
        self._is_mask_verified = True
        after = self.hashes(others)
        changed = [slot for slot in others if before[slot] != after[slot]]
        if changed:
            raise Error(
                f"`reset` of `{self._name}` must reset the slots in `options['reset_mask']` only,"
                f" but it changed the observation of slot {changed[0]}, whose episode runs"
            )

    def _check_observations(self, function: str) -> None:
        space = self.envs.observation_space
        problem = batches.shape_problem(space, self.observations, "observations")
        if problem is not None:
            raise Error(f"`{function}` of `{self._name}` returned {problem}")

    def _checked(self, function: str, result: Any, names: tuple[str, ...]) -> Any:
        if isinstance(result, tuple) and len(result) == len(names):
            return result
        got = f"{len(result)} results" if isinstance(result, tuple) else type(result).__name__
        expected = f"{len(names)}: {', '.join(names)}"
        raise Error(f"`{function}` of `{self._name}` returned {got}, expected {expected}")
