"""Carries out the steps of a plug-in: set-up, run, check, tear-down."""

from __future__ import annotations

import os
import signal
import sys

from rtf import _exceptions, _session
from rtf._fixture import FixtureManager, Test
from rtf._stop import Interrupted, StepEnded
from rtf._test import TestCase
from rtf.host import load, yarp_network

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import FrameType
    from typing import Callable, TypeVar

    from rtf._session import Session

    _Result = TypeVar("_Result")

Answer = dict[str, object]

# The session whose plug-in the main thread runs, if any. Only the main thread and its
# signal handler use it.
_interruptible: list[Session] = []


def run_test(session: Session) -> Answer:
    """Load a test, set it up, run it and tear it down."""
    test = _load(session, TestCase)
    if test is not None and _fits(session, test):
        has_setup = _has_own(test, "setup")
        session.announce("setup", held=not has_setup)
        session.sampling.begin()
        if has_setup:
            _step(session, lambda: test.setup(session.task.args), "setup")
        if session.request.has_passed():
            session.announce("run")
            _step(session, _run_of(session, test), "run")
        has_tear_down = _has_own(test, "tearDown")
        session.announce("tear-down", held=not has_tear_down)
        if has_tear_down:
            _tear_down(session, test)
        yarp_network.finish()
    return _answer(session)


def _fits(session: Session, test: TestCase) -> bool:
    """Whether the suite treats the test as what it is, an episode test or not."""
    settings, name = session.task.episodes, type(test).__name__
    # Imported by an episode test.
    module = sys.modules.get("rtf._episode_test")
    is_episode_test = module is not None and isinstance(test, module.EpisodeTest)
    if is_episode_test and settings is None:
        session.error(f'`{name}` is an episode test, which needs `slots`: `<test slots="1">`')
    elif settings is not None and not is_episode_test:
        session.error(f"the test has `slots`, but `{name}` is not derived from `rtf.EpisodeTest`")
    elif settings is not None:
        from rtf import _episodes  # noqa: PLC0415 - other tests do not need it

        session.episodes = _episodes.Episodes(session, settings)
        session.sampling.is_by_case = True
    return is_episode_test == (settings is not None)


def _run_of(session: Session, test: TestCase) -> Callable[[], object]:
    episodes = session.episodes
    return test.run if episodes is None else lambda: episodes.run(test.run)


def _has_own(test: TestCase, step: str) -> bool:
    """Whether the plug-in implements a step: otherwise two lines are sent in one write."""
    return getattr(type(test), step) is not getattr(TestCase, step) or step in vars(test)


def set_up_fixture(
    session: Session, present: FixtureManager | None
) -> tuple[FixtureManager | None, Answer]:
    """Load a fixture and set it up. Return the fixture if it was loaded."""
    if present is not None:
        session.request.record("error", "a fixture is still set up in this host")
        return present, _answer(session)
    fixture = _load(session, FixtureManager)
    if fixture is not None:
        _step(session, lambda: fixture.setup(session.task.args), "setup")
    answer = _answer(session)
    subscriptions = _subscriptions(fixture) if fixture is not None else []
    if subscriptions and answer["outcome"] == "passed":
        answer["subscriptions"] = subscriptions
    return fixture, answer


def check_fixture(session: Session, fixture: FixtureManager | None) -> Answer:
    """Call a fixture's `check`."""
    if fixture is None:
        session.request.record("error", "no fixture is set up")
    else:
        _step(session, fixture.check, "check")
    return _answer(session)


def notify_fixture(
    session: Session, fixture: FixtureManager | None, method: str, params: dict[str, object]
) -> Answer:
    """Notify a fixture that a test is about to start, or of its verdict."""
    test = _test_of(params)
    if fixture is None:
        session.request.record("error", "no fixture is set up")
    elif method == "test-started":
        _step(session, lambda: fixture.testStarted(test), "testStarted")
    else:
        verdict, reason = str(params.get("verdict")), str(params.get("reason") or "")
        _step(session, lambda: fixture.testFinished(test, verdict, reason), "testFinished")
    return _answer(session)


def _test_of(params: dict[str, object]) -> Test:
    test = params.get("test")
    fields = test if isinstance(test, dict) else {}
    numbers = [int(fields.get(name, 0)) for name in ("id", "repetition", "attempt")]
    return Test(numbers[0], str(fields.get("name", "")), numbers[1], numbers[2])


def _subscriptions(fixture: FixtureManager) -> list[str]:
    """Return the notifications for which a fixture has a function."""
    own, base = type(fixture), FixtureManager
    functions = {"test-started": "testStarted", "test-finished": "testFinished"}
    return [n for n, f in functions.items() if getattr(own, f) is not getattr(base, f)]


def tear_down_fixture(session: Session, fixture: FixtureManager | None) -> Answer:
    """Tear a fixture down, if it was loaded."""
    if fixture is not None:
        _tear_down(session, fixture)
        yarp_network.finish()
    return _answer(session)


def _load(session: Session, base: type[load._P]) -> load._P | None:
    loaded = _guard(session, lambda: load.load(session.task.file, base))
    if not loaded:
        return None
    yarp_network.init()
    return loaded[0]


def _step(session: Session, function: Callable[[], object], step: str) -> None:
    """Carry out a step and check its result."""
    results = _guard(session, function)
    if results and step != "run" and _is_false(results[0]):
        session.request.record("error" if step == "setup" else "failed", f"{step} returned false")
    if results and (hasattr(results[0], "__await__") or hasattr(results[0], "__next__")):
        # The function has not run: this must not be a success.
        session.error(f"{step} is a coroutine or a generator, which nobody runs")


def _tear_down(session: Session, plugin: TestCase | FixtureManager) -> None:
    # It can wait until the runner asks again.
    session.request.stop.clear()
    _guard(session, plugin.tearDown)


def _guard(session: Session, function: Callable[[], _Result]) -> list[_Result]:
    """Call the plug-in; return its result, or nothing after an exception, which is reported.

    Only `SystemExit` propagates.
    """
    process = os.getpid()
    results: list[_Result] = []
    try:
        try:
            _interruptible.append(session)
            results.append(function())
        finally:
            _interruptible.clear()
    except StepEnded:
        pass  # recorded before it was raised
    except SystemExit:
        raise  # the plug-in ends its process
    except load.LoadError as problem:
        session.error(str(problem))
    except BaseException as problem:  # noqa: BLE001 - also KeyboardInterrupt and the plug-in's own
        # A library that replaced the signal handler raises KeyboardInterrupt.
        if not (isinstance(problem, KeyboardInterrupt) and session.request.stop.is_set()):
            _exceptions.report(session, problem)
    if os.getpid() != process:
        # A forked child returned from the plug-in; its parent serves the runner.
        _flush_output()
        session.sampling.send()
        os._exit(0)
    return results


def _is_false(result: object) -> bool:
    """Whether it is `False` or numpy's `False_`."""
    return type(result).__name__ in {"bool", "bool_"} and not result


def _flush_output() -> None:
    for stream in (sys.stdout, sys.stderr):
        stream.flush()


def _answer(session: Session) -> Answer:
    _flush_output()
    session.sampling.send()
    return session.request.answer()


def stop_by_signal(number: int, frame: FrameType | None) -> None:
    """Handle SIGINT: end the plug-in's function if the host sent the signal."""
    session = _session.running()
    if session is None or not session.request.take_announced_signal():
        signal.default_int_handler(number, frame)
    elif _interruptible and session.request.stop.is_set():
        raise Interrupted(session.request.stop_reason)
