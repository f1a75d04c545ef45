"""Runs episodes in the slots of a vector environment."""

from __future__ import annotations

import math
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from rtf import _session
from rtf._episodes import summary
from rtf._stop import Error, Interrupted
from rtf.gymnasium import batches, environments, verification
from rtf.gymnasium.vector_test import EpisodeEnd, VectorTest

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtf._episode import Episode
    from rtf._episodes import Episodes
    from rtf.gymnasium.slots import Slots


class Loop:
    """The episodes that run in the slots."""

    def __init__(self, test: VectorTest, slots: Slots, episodes: Episodes) -> None:
        """Prepare slots without episodes."""
        self._test = test
        self._slots = slots
        self._episodes = episodes
        self._timestep = _timestep(test)
        self._last_step = _last_step(episodes, self._timestep)
        # The episodes, by their slots.
        self._open: dict[int, Episode] = {}
        self._is_verified = False

    def run(self) -> None:
        """Run all episodes."""
        request = _session.current().request
        while self._fill():
            if request.stop.is_set():
                raise Interrupted(request.stop_reason)
            actions = self._test.act(self._slots.observations)
            self._slots.check_actions(actions)
            with self._attributed_to_all("step"):
                self._slots.step(actions)
            self._episodes.is_holding = True
            try:
                self._end_episodes()
            finally:
                self._episodes.is_holding = False

    def _fill(self) -> bool:
        """Start episodes in free slots; whether any episode is open."""
        if len(self._open) == self._slots.count:
            return True
        while True:
            free = [slot for slot in range(self._slots.count) if slot not in self._open]
            taken = self._test.take(len(free), wait=not self._open) if free else []
            if not taken:
                # Environments and the policy may take long, or crash.
                self._episodes.flush()
            if not taken and not self._open:
                return False
            running = list(self._open)
            started = dict(zip(free, taken))
            self._open.update(started)
            for slot in started:
                if not self._is_verified:
                    self._verify(slot)
            for slot in started:
                self._configure(slot, [slot])
            self._reset([slot for slot in started if slot in self._open], running)
            if self._open:
                return True

    def _configure(self, slot: int, slots: Iterable[int]) -> None:
        """Give slots the parameters of an episode, which an exception ends."""
        episode = self._open.get(slot)
        if episode is not None:
            with episode:
                for one in slots:
                    self._test.configure(self._slots.envs, one, episode)
            if episode.is_finished:
                del self._open[slot]

    def _verify(self, slot: int) -> None:
        """Verify the seeds, with the parameters of an episode in all slots."""
        test, slots, first = self._test, self._slots, self._open[slot]
        is_default = type(test).configure is VectorTest.configure
        if first.parameters and is_default and not slots.parameters.is_taken:
            names = ", ".join(f"`{name}`" for name in first.parameters)
            raise Error(
                f"the campaign has the parameters {names}, but the environments have no attribute"
                " `parameters`: add it to them, or write `configure(self, envs, slot, episode)`"
            )
        self._configure(slot, range(slots.count))
        if first.is_finished:
            return  # with the next one
        try:
            with self._attributed_to_all("reset"):
                remark = verification.verify(slots, first.seed)
        except verification.ResetError as problem:
            self._end_with_error(slot, *problem.args)
            return
        self._is_verified = True
        if remark is not None:
            test.report(remark)

    def _reset(self, started: list[int], running: list[int]) -> None:
        """Reset the slots of new episodes, and those that are done and have none."""
        done = map(int, np.flatnonzero(self._slots.done))
        idle = [slot for slot in done if slot not in self._open]
        if not self._open or not (started or idle):
            return
        # Repeats an episode that runs: what is wrong in it is wrong in that episode, too.
        model = next(iter(self._open.values()))
        for slot in idle:
            self._test.configure(self._slots.envs, slot, model)
        seeds = {slot: self._open.get(slot, model).seed for slot in (*started, *idle)}
        with self._attributed_to_all("reset"):
            self._slots.reset_some(seeds, running)
        errors, has_nan = self._slots.errors(), self._slots.has_nan()
        for slot in started:
            if slot in errors:
                self._end_with_error(slot, *errors[slot])
            elif has_nan[slot]:
                self._end_with_error(slot, verification.NAN_AT_FIRST)
            else:
                self._open[slot].record(None, None, self._slots.observation(slot))

    def _end_episodes(self) -> None:
        slots = self._slots
        if not slots.may_have_ended(self._last_step):
            return
        has_nan, errors = slots.has_nan(), slots.errors()
        is_over = slots.done | has_nan | np.isnan(slots.rewards) | (slots.steps >= self._last_step)
        is_over[list(errors)] = True
        for slot in map(int, np.flatnonzero(is_over)):
            episode = self._open.get(slot)
            if episode is None:
                continue
            steps = int(slots.steps[slot])
            episode.record(steps, None if self._timestep is None else steps * self._timestep, None)
            if slot in errors:
                self._end_with_error(slot, *errors[slot])
            elif np.isnan(slots.rewards[slot]):
                self._end_with_error(slot, f"the reward of step {steps} is NaN")
            elif has_nan[slot]:
                self._end_with_error(slot, f"the observation after step {steps} contains NaN")
            elif slots.done[slot]:
                self._judge(slot)
            else:
                time = None if self._timestep is None else (steps + 1) * self._timestep
                reason = self._episodes.limit_reason(steps + 1, time)
                self._episodes.end(self._open.pop(slot), "timed-out", reason)

    def _judge(self, slot: int) -> None:
        slots, episode = self._slots, self._open.pop(slot)
        end = EpisodeEnd(
            episode=episode,
            info=batches.info_of(slots.infos, slot),
            reward=float(slots.rewards[slot]),
            steps=int(slots.steps[slot]),
            terminated=bool(slots.terminated[slot]),
            truncated=bool(slots.truncated[slot]),
        )
        with episode:
            verdict = self._test.judge(end)
            if isinstance(verdict, str):
                episode.finish(passed=False, reason=verdict)
            elif type(verdict).__name__ in {"bool", "bool_"}:
                episode.finish(verdict)
            else:
                raise TypeError(f"`judge` returned {verdict!r}, expected a truth or a text")

    def _end_with_error(self, slot: int, text: str, place: dict[str, object] | None = None) -> None:
        episode = self._open.pop(slot)
        with episode:
            _session.current().error(text, location=place)
        self._episodes.end(episode, None)

    @contextmanager
    def _attributed_to_all(self, function: str) -> Iterator[None]:
        """Make an exception an error of all open episodes: it does not say in which slot it was.

        An episode whose environment was in a process that has ended has crashed.
        """
        try:
            yield
        except verification.ResetError:
            raise
        except Exception as problem:
            ended = environments.ended_processes(self._slots.envs, problem)
            suspects = len(self._open)
            where = "" if suspects == 1 else f", in one of {suspects} slots"
            for slot, episode in self._open.items():
                if slot in ended:
                    reason = f"the process of its environment ended with {ended[slot]}"
                    self._episodes.end(episode, "crashed", reason)
                elif isinstance(problem, Error):
                    self._episodes.end(episode, "error", str(problem))
                else:
                    reason = f"`{function}` raised {summary(problem)}{where}"
                    self._episodes.end(episode, "error", reason)
            raise


def _timestep(test: VectorTest) -> float | None:
    """Return the simulated time of a step in s, if the test knows it."""
    if test.timestep is None and test.max_time is not None:
        name = type(test).__name__
        raise Error(f"the suite has `max-time`, but `{name}` has no `timestep`, in s")
    if test.timestep is not None and not 0 < float(test.timestep) < math.inf:
        raise Error(f"`timestep` is {test.timestep} s, expected a number above 0")
    return None if test.timestep is None else float(test.timestep)


def _last_step(episodes: Episodes, timestep: float | None) -> float:
    """Return the number of the last step within the limits of the suite."""
    settings = episodes.settings
    last = math.inf if settings.max_steps is None else settings.max_steps
    if timestep is None or settings.max_time is None:
        return last
    if episodes.limit_reason(1, timestep):
        raise Error(f"`timestep` is {timestep} s, longer than `max-time` of the suite")
    # Sums of time steps are not exact.
    return min(last, math.floor(settings.max_time / timestep * (1 + 1e-9)))
