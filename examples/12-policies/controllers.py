"""Two controllers of the arm: one knows its equations, the other one has learned from it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
TORQUES = np.array([20.0, 8.0])
"""The limits of the motors, in newton metres."""

STIFFNESS, DAMPING = np.array([60.0, 20.0]), np.array([8.0, 2.5])
"""The gains of `pd`, in newton metres per radian and newton metre seconds per radian."""


def pd(observations: Array) -> Array:
    """Proportional-derivative control, with compensation of gravity and payload."""
    return np.clip(_torques(observations), -1, 1)


def _torques(observations: Array) -> Array:
    """What `pd` would apply without limits, in parts of those."""
    angles, speeds, goals = (observations[:, start : start + 2] for start in (0, 2, 4))
    hand = 0.1 + observations[:, 6]
    forearm = 9.81 * (0.15 * 0.6 + 0.3 * hand) * np.cos(angles.sum(axis=1))
    upper = 9.81 * (0.2 * 1.0 + 0.4 * (0.6 + hand)) * np.cos(angles[:, 0])
    gravity = -np.stack([upper + forearm, forearm], axis=1)
    torques: Array = (STIFFNESS * (goals - angles) - DAMPING * speeds + gravity) / TORQUES
    return torques


class Learned:
    """A network with one hidden layer that imitates `pd`, from demonstrations with up to 1 kg."""

    def __init__(self, units: int = 200, demonstrations: int = 4000) -> None:
        random = np.random.default_rng(7)
        self._low = np.array([-1.2, -0.8, -6, -6, -1.2, -0.2, 0])
        self._high = np.array([1.8, 1.4, 6, 6, 1.2, 1.0, 1])
        self._weights = random.normal(0, 0.2, (7, units))
        self._bias = random.normal(0, 0.7, units)
        seen = random.uniform(self._low, self._high, (demonstrations, 7))
        self._output = np.linalg.lstsq(self._features(seen), _torques(seen), rcond=None)[0]

    def __call__(self, observations: Array) -> Array:
        return np.clip(self._features(observations) @ self._output, -1, 1)

    def _features(self, observations: Array) -> Array:
        # Inputs are limited to those of the demonstrations, as usual.
        inputs = np.clip(observations, self._low, self._high)
        return np.hstack([inputs, np.tanh(inputs @ self._weights + self._bias)])


CONTROLLERS: dict[str, Callable[[], Callable[[Array], Array]]] = {
    "pd": lambda: pd,
    "learned": Learned,
}
