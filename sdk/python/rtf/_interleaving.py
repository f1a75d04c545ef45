"""Runs episodes that are generators, one step of each in turn."""

from __future__ import annotations

from contextvars import copy_context

from rtf import _exceptions, _session
from rtf._stop import Interrupted

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Generator
    from typing import Any

    from rtf._episode import Episode
    from rtf._episode_test import EpisodeTest
    from rtf._episodes import Episodes

# `bool_` is numpy's.
_TRUTHS = ("bool", "bool_")


def run(test: EpisodeTest, episodes: Episodes) -> None:
    """Run all episodes of a test."""
    slots = episodes.settings.slots
    request = _session.current().request
    running: list[Running] = []
    try:
        while True:
            free = slots - len(running)
            new = episodes.take(free, wait=not running) if free else []
            if not new and not running:
                return
            running += [Running(test, episodes, one) for one in new]
            still = []
            for one in running:
                if request.stop.is_set():
                    raise Interrupted(request.stop_reason)
                if one.context.run(one.advance):
                    still.append(one)
            running = still
    finally:
        # After an exception: their `finally` blocks must run.
        for one in running:
            one.context.run(one.close)


class Running:
    """An episode that runs, in a separate context: it may `yield` in a case."""

    __slots__ = ("_episode", "_episodes", "_generator", "_steps", "_test", "_time", "context")

    def __init__(self, test: EpisodeTest, episodes: Episodes, episode: Episode) -> None:
        """Prepare an episode."""
        self._test = test
        self._episodes = episodes
        self._episode = episode
        self._generator: Generator[float | None, None, Any] | None = None
        self._steps = 0
        self._time: float | None = None
        self.context = copy_context()

    def advance(self) -> bool:
        """Run until the next step; whether the episode continues."""
        cases = _session.current().cases
        try:
            if self._generator is not None:
                cases.resume(cases.innermost())
                return self._step(self._generator)
            self._episodes.enter(self._episode)
            result: Any = self._test.episode(self._episode)
            if hasattr(result, "__next__"):
                self._generator = result
                self._time = None if self._episodes.settings.max_time is None else 0.0
                return self._step(result)
            self._finish(result, None)
            return False
        except BaseException as problem:
            if not self._episodes.absorb(self._episode, problem):
                raise
            return False
        finally:
            cases.resume(None)

    def _step(self, generator: Generator[float | None, None, Any]) -> bool:
        try:
            passed_time = next(generator)
        except StopIteration as end:
            self._finish(end.value, self._steps)
            return False
        if self._episode.is_finished:
            generator.close()
            return False
        reason = self._count(passed_time)
        if not reason:
            self._steps += 1
            return True
        generator.close()
        self._episode.record(self._steps, self._time, None)
        self._episodes.end(self._episode, "timed-out", reason)
        return False

    def _count(self, passed: float | None) -> str:
        """Add the time of a step; the reason if a limit is exceeded."""
        if passed is None and self._episodes.settings.max_time is None:
            return self._episodes.limit_reason(self._steps + 1, None)
        if passed is None:
            raise TypeError("the suite has `max-time`, so `yield` needs the seconds that passed")
        if not float(passed) >= 0:
            raise ValueError(f"a step of {passed} s: expected seconds from 0")
        time = (self._time or 0.0) + float(passed)
        reason = self._episodes.limit_reason(self._steps + 1, time)
        if not reason:
            self._time = time
        return reason

    def _finish(self, result: Any, steps: int | None) -> None:
        if hasattr(result, "__await__"):
            result.close()
            raise TypeError("`episode` is a coroutine, expected a generator")
        if self._episode.is_finished and result is None:
            return
        if isinstance(result, str):
            self._episode.finish(passed=False, reason=result, steps=steps, time=self._time)
        elif result is None or type(result).__name__ in _TRUTHS:
            self._episode.finish(result, steps=steps, time=self._time)
        else:
            raise TypeError(f"`episode` returned {result!r}, expected None, a truth or a text")

    def close(self) -> None:
        """End its generator early, after an exception of another one."""
        if self._generator is not None:
            try:
                self._generator.close()
            except Exception as problem:  # noqa: BLE001 - the plug-in's own
                _exceptions.report(_session.current(), problem)
