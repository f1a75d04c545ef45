"""The episodes of a test: taken from the runner, and finished in any order."""

from __future__ import annotations

from rtf import _exceptions, _text
from rtf._arrivals import Arrivals
from rtf._episode import Episode
from rtf._stop import CriticalAssertionEnded, Error, Interrupted, Skipped, StepEnded

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

    from rtf._session import Session
    from rtf._task import EpisodeSlots

# How many ids an error lists.
_IDS_SHOWN = 5


class Episodes:
    """The episodes of a test."""

    def __init__(self, session: Session, settings: EpisodeSlots) -> None:
        """Expect episodes of the runner."""
        self.settings = settings
        self.open: dict[int, Episode] = {}
        # Whether several episodes end within moments: then their results are sent in one write.
        self.is_holding = False
        self._session = session
        self._arrivals = Arrivals(session.request)

    def take(self, most: int | None, *, wait: bool) -> list[Episode]:
        """Start episodes that have arrived."""
        session = self._session
        if session.phase != "run" or session.cases.is_forked():
            raise RuntimeError("episodes can be taken in `run` of the test only")
        arrivals = self._arrivals
        while True:
            with arrivals.lock:
                arrivals.update()
                count = self._count(most, wait=wait)
                if not wait or arrivals.episodes or arrivals.have_ended:
                    count = min(count, len(arrivals.episodes))
                    taken = [arrivals.episodes.popleft() for _ in range(count)]
                    arrivals.wake_next()
                    return self._start(taken) if taken else []
                arrivals.announce_wait()
            session.sampling.send()
            self.flush()
            arrivals.wait()

    def _count(self, most: int | None, *, wait: bool) -> int:
        """Return how many episodes may start, at most."""
        slots = self.settings.slots
        free = slots - len(self.open)
        count = free if most is None else min(most, free)
        if wait and count < 1:
            what = f"`most` is {most}" if free > 0 else f"none of {slots} slots is free"
            raise ValueError(f"`take` would wait without an end: {what}")
        return max(count, 0)

    def flush(self) -> None:
        """Send held results."""
        self._session.flush()

    def _start(self, taken: list[dict[str, Any]]) -> list[Episode]:
        numbers = self._session.cases.start_episodes([one["id"] for one in taken])
        episodes = [Episode(self, case, one) for case, one in enumerate(taken, numbers)]
        self.open.update((one.case, one) for one in episodes)
        return episodes

    def enter(self, episode: Episode) -> None:
        """Attribute what this thread reports from now on to an episode."""
        self._session.cases.enter(episode.case, str(episode.id))

    def leave(self, episode: Episode, problem: BaseException | None) -> bool:
        """End what `enter` began; whether an exception ended only the episode."""
        session, cases = self._session, self._session.cases
        entry = cases.entered(episode.case)
        if entry is None:
            return False
        is_stopped = isinstance(problem, Interrupted) or session.request.stop.is_set()
        if is_stopped or cases.ends_process(problem):
            cases.abandon(entry, is_stopped=is_stopped)
            return False
        try:
            return problem is not None and self.absorb(episode, problem)
        finally:
            cases.leave(entry)

    def absorb(self, episode: Episode, problem: BaseException) -> bool:
        """Finish an episode that an exception ended, unless it ends more than the episode.

        After its end, the exception is a problem of the test.
        """
        if isinstance(problem, (GeneratorExit, SystemExit, Interrupted)):
            return False
        if not isinstance(problem, StepEnded):
            _exceptions.report(self._session, problem)
        if not episode.is_finished:
            is_skipped = isinstance(problem, Skipped)
            reason = str(problem) if is_skipped else ""
            self.end(episode, "skipped" if is_skipped else None, reason)
        return not isinstance(problem, CriticalAssertionEnded)

    def end(self, episode: Episode, outcome: str | None, reason: str = "") -> None:
        """Finish an episode; without an outcome, the problems reported in it decide."""
        cases = self._session.cases
        if self._session.phase != "run":
            raise RuntimeError(f"episode {episode.id} cannot be finished after `run`")
        if episode.is_finished:
            raise RuntimeError(f"episode {episode.id} is finished already")
        if cases.has_open_inner(episode.case):
            raise RuntimeError(f"episode {episode.id} has a case that is open: finish it first")
        if self.open.pop(episode.case, None) is None:
            raise RuntimeError(f"episode {episode.id} belongs to another test")
        episode.is_finished = True
        end = episode.encoded_end(outcome, reason)
        cases.finish_episode(episode.case, end, held=self.is_holding)

    def limit_reason(self, steps: int | None, time: float | None) -> str:
        """Return why an episode that takes so many steps, or so long, has timed out, if it has."""
        most, limit = self.settings.max_steps, self.settings.max_time
        if most is not None and steps is not None and steps > most:
            return f"not done after {most} steps"
        # Sums of time steps are not exact.
        if limit is not None and time is not None and time > limit * (1 + 1e-9):
            return f"not done after {_text.number(limit)} s of simulated time"
        return ""

    def run(self, function: Callable[[], object]) -> object:
        """Call `run` of the test, and finish what it leaves open."""
        try:
            result = function()
        except (Interrupted, SystemExit):
            raise  # the runner finishes them
        except BaseException as problem:
            self._end_open(f"`run` ended with {summary(problem)}")
            raise
        self._require_end()
        return result

    def _require_end(self) -> None:
        if self.open:
            ids = [one.id for one in self.open.values()]
            shown = ", ".join(map(str, ids[:_IDS_SHOWN])) + (", …" if ids[_IDS_SHOWN:] else "")
            self._end_open("`run` ended while the episode was open")
            text = f"`run` ended while {len(ids)} episodes were open: {shown}"
            self._session.end_with_error(text)
        arrivals = self._arrivals
        arrivals.update()
        if not arrivals.have_ended and not arrivals.episodes:
            arrivals.announce_wait()
            arrivals.wait()
            arrivals.update()
        if arrivals.episodes or not arrivals.have_ended:
            text = "`run` ended, but more episodes follow until `take` returns an empty list"
            self._session.end_with_error(text)

    def _end_open(self, reason: str) -> None:
        cases = self._session.cases
        if not cases.is_forked():
            for episode in list(self.open.values()):
                # The runner finishes one in which a thread has left a case open.
                if not cases.has_open_inner(episode.case):
                    self.end(episode, "error", reason)


def summary(problem: BaseException) -> str:
    """Return an exception in one line."""
    text = str(problem).partition("\n")[0]
    if isinstance(problem, (StepEnded, Error)):
        return f"`{text}`"
    return f"{type(problem).__name__}: {text}" if text else type(problem).__name__
