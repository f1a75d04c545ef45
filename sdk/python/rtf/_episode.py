"""An episode of a campaign, as a test sees it."""

from __future__ import annotations

import json
import math
from operator import index

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import TracebackType
    from typing import Any

    from rtf._episodes import Episodes


class Episode:
    """An episode that has started: `id`, `seed` and `parameters` are the campaign's.

    What is reported in `with episode:` belongs to it. An assertion or an exception in it ends the
    episode, and the test continues.
    """

    __slots__ = (
        "_first_observation",
        "_owner",
        "_steps",
        "_time",
        "case",
        "id",
        "is_finished",
        "parameters",
        "seed",
    )

    def __init__(self, owner: Episodes, case: int, fields: dict[str, Any]) -> None:
        """Describe one that the runner sent, and that is the case number `case` of the test."""
        self._owner = owner
        self.case = case
        self.id: int = fields["id"]
        """Its number in the campaign, from 1."""
        self.seed: int = fields["seed"]
        """For all of its random numbers: from 0 to 2³¹ - 1."""
        self.parameters: dict[str, str] = fields.get("parameters") or {}
        """The values of the campaign's parameters, by their names."""
        self.is_finished = False
        """Whether it has a result."""
        self._steps: int | None = None
        self._time: float | None = None
        self._first_observation: str | None = None

    def parameter(self, name: str, default: str | None = None) -> str:
        """Return the value of a parameter as text.

        An unknown name without a default is a `LookupError` that lists the known ones.
        """
        value = self.parameters.get(name, default)
        if value is None:
            known = ", ".join(self.parameters) or "none"
            raise LookupError(f"there is no parameter `{name}`; this episode has: {known}")
        return value

    def __enter__(self) -> Episode:
        """Attribute what this thread reports to the episode."""
        self._owner.enter(self)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        problem: BaseException | None,
        trace: TracebackType | None,
    ) -> bool:
        """Swallow an exception that ends only the episode."""
        return self._owner.leave(self, problem)

    def finish(
        self,
        passed: bool | None = None,  # noqa: FBT001 - as in all languages
        reason: str = "",
        *,
        steps: int | None = None,
        time: float | None = None,
        first_observation: Any = None,
    ) -> None:
        """End the episode. Without `passed`, the problems that were reported in it decide.

        A reported problem has precedence over `passed`; `reason` is that of a failure. `steps`
        is how many steps it took, `time` its duration in simulated time in s. The hash of
        `first_observation` (bytes, a text, or a numpy array of any shape) is stored, so that
        two runs of the episode can be compared. With `max-steps` or `max-time` in the suite,
        `steps` or `time` is necessary unless it failed; above the limit it has timed out.
        """
        if passed is not None and type(passed).__name__ not in {"bool", "bool_"}:
            raise TypeError(f"`passed` is {passed!r}, expected True, False or None")
        self.record(steps, time, first_observation)
        if passed is not None and not passed:
            self._owner.end(self, "failed", str(reason))
            return
        limit = self._exceeded_limit()
        outcome = None if passed is None else "passed"
        self._owner.end(self, "timed-out" if limit else outcome, limit)

    def observe(self, observation: Any) -> None:
        """Record the first observation, as `finish` does; further calls have no effect."""
        if self._first_observation is None:
            self.record(None, None, observation)

    def record(self, steps: int | None, time: float | None, first_observation: Any) -> None:
        """Record what its end reports: see `finish`."""
        if steps is not None:
            self._steps = index(steps)
            if self._steps < 0:
                raise ValueError(f"`steps` is {steps}, expected a number from 0")
        if time is not None:
            self._time = float(time)
            if not 0 <= self._time < math.inf:
                raise ValueError(f"`time` is {time} s, expected a number from 0")
        if first_observation is not None:
            from rtf import _digest  # noqa: PLC0415 - only if it is used

            self._first_observation = _digest.of(first_observation)

    def _exceeded_limit(self) -> str:
        """Return the reason if it took longer than a limit of the suite."""
        settings = self._owner.settings
        for name, limit, value, argument in (
            ("max-steps", settings.max_steps, self._steps, "steps"),
            ("max-time", settings.max_time, self._time, "time"),
        ):
            if limit is not None and value is None:
                raise ValueError(f"the suite has `{name}`, so `finish` needs `{argument}`")
        return self._owner.limit_reason(self._steps, self._time)

    def encoded_end(self, outcome: str | None, reason: str) -> bytes:
        """Encode the fields of `case-finished`, each with a comma before it."""
        fields = "" if outcome is None else f', "outcome": "{outcome}"'
        if reason:
            # A file name that is not UTF-8 holds lone surrogates.
            fields += f', "reason": {json.dumps(reason.encode("utf-8", "replace").decode())}'
        more = []
        if self._steps is not None:
            more.append(f'"steps": {self._steps}')
        if self._time is not None:
            more.append(f'"time_us": {round(self._time * 1e6)}')
        if self._first_observation is not None:
            more.append(f'"first_observation": "{self._first_observation}"')
        if more:
            fields += f', "episode": {{{", ".join(more)}}}'
        return fields.encode()
