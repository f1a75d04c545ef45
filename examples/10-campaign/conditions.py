"""What varies between two episodes."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Conditions:
    """What varies between two episodes."""

    payload: float
    """Kilograms in the hand."""
    friction: float
    """Newton metres of dry friction in each joint."""
    noise: float
    """The standard deviation of the encoders, in radians."""
    seed: int

    @classmethod
    def of(cls, variables: dict[str, str]) -> Conditions:
        """Reads the variables of an episode."""
        return cls(
            payload=float(variables.get("RTF_PARAM_PAYLOAD", "0.2")),
            friction=float(variables.get("RTF_PARAM_FRICTION", "0.1")),
            noise=float(variables.get("RTF_PARAM_NOISE", "0.001")),
            seed=int(variables.get("RTF_EPISODE_SEED", "0")),
        )
