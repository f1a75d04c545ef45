"""Carries out the steps of a plug-in: set-up, run, check, tear-down."""

from __future__ import annotations

import os
import signal
import sys

from rtf import _location, _session
from rtf._fixture import FixtureManager, Test
from rtf._stop import Error, Interrupted, StepEnded
from rtf._test import TestCase
from rtf.host import load

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import FrameType
    from typing import Callable

    from rtf._session import Session

Answer = dict[str, object]

# The session whose plug-in's code the main thread carries out right now, if
# any. Only the main thread and its signal handler look at it.
_interruptible: list[Session] = []


def run_test(session: Session) -> Answer:
    """Load a test, set it up, run it and tear it down."""
    test = _load(session, TestCase)
    if test is not None:
        has_setup = _has_own(test, "setup")
        session.announce("setup", held=not has_setup)
        session.sampling.begin()
        if has_setup:
            _step(session, lambda: test.setup(session.task.args), "setup")
        if session.judge.first() is None:
            session.announce("run")
            session.judge.failures_are_errors = False
            _step(session, test.run, "run")
            session.judge.failures_are_errors = True
        has_tear_down = _has_own(test, "tearDown")
        session.announce("tear-down", held=not has_tear_down)
        if has_tear_down:
            _tear_down(session, test)
    return _answer(session)


def _has_own(test: TestCase, step: str) -> bool:
    """Whether there is code of the plug-in to be called: without, two lines need one write."""
    return getattr(type(test), step) is not getattr(TestCase, step) or step in vars(test)


def set_up_fixture(
    session: Session, present: FixtureManager | None
) -> tuple[FixtureManager | None, Answer]:
    """Load a fixture and set it up. It is returned if it was loaded, well or not."""
    if present is not None:
        session.judge.note("error", "a fixture is still set up in this host")
        return present, _answer(session)
    fixture = _load(session, FixtureManager)
    if fixture is not None:
        _step(session, lambda: fixture.setup(session.task.args), "setup")
    answer = _answer(session)
    notices = _notices(fixture) if fixture is not None else []
    if notices and answer["outcome"] == "passed":
        answer["subscriptions"] = notices
    return fixture, answer


def check_fixture(session: Session, fixture: FixtureManager | None) -> Answer:
    """Ask a fixture whether it is well."""
    session.judge.failures_are_errors = False
    if fixture is None:
        session.judge.note("error", "no fixture is set up")
    else:
        _step(session, fixture.check, "check")
    return _answer(session)


def tell_fixture(
    session: Session, fixture: FixtureManager | None, method: str, params: dict[str, object]
) -> Answer:
    """Tell a fixture that a test is about to begin, or how it was judged."""
    session.judge.failures_are_errors = False
    test = _test_of(params)
    if fixture is None:
        session.judge.note("error", "no fixture is set up")
    elif method == "test-started":
        _step(session, lambda: fixture.testStarted(test), "testStarted")
    else:
        verdict, reason = str(params.get("verdict")), str(params.get("reason") or "")
        _step(session, lambda: fixture.testFinished(test, verdict, reason), "testFinished")
    return _answer(session)


def _test_of(params: dict[str, object]) -> Test:
    told = params.get("test")
    fields = told if isinstance(told, dict) else {}
    numbers = [int(fields.get(name, 0)) for name in ("id", "repetition", "attempt")]
    return Test(numbers[0], str(fields.get("name", "")), numbers[1], numbers[2])


def _notices(fixture: FixtureManager) -> list[str]:
    """Return what a fixture wants to be told of tests: that for which it has a function."""
    own, base = type(fixture), FixtureManager
    notices = []
    if own.testStarted is not base.testStarted:
        notices.append("test-started")
    if own.testFinished is not base.testFinished:
        notices.append("test-finished")
    return notices


def tear_down_fixture(session: Session, fixture: FixtureManager | None) -> Answer:
    """Tear a fixture down. One that could not be loaded has nothing to tear down."""
    if fixture is not None:
        _tear_down(session, fixture)
    return _answer(session)


def _load(session: Session, base: type[load._P]) -> load._P | None:
    loaded: list[load._P] = []
    _guard(session, lambda: loaded.append(load.load(session.task.file, base)))
    return loaded[0] if loaded else None


def _step(session: Session, function: Callable[[], object], what: str) -> bool:
    """Carry out a step and look at what it returns; whether all is well so far."""
    results: list[object] = []
    _guard(session, lambda: results.append(function()))
    if results and what != "run" and _is_false(results[0]):
        session.judge.note_failure(f"{what} returned false")
    if results and (hasattr(results[0], "__await__") or hasattr(results[0], "__next__")):
        # Nothing of such a function has run: it must not look like a success.
        session.error(f"{what} is a coroutine or a generator, which nobody runs")
    return session.judge.first() is None


def _tear_down(session: Session, plugin: TestCase | FixtureManager) -> None:
    session.judge.clear_stop()
    _guard(session, plugin.tearDown)


def _guard(session: Session, function: Callable[[], object]) -> None:
    """Call into the plug-in and record what it raises. Only `SystemExit` gets through."""
    process = os.getpid()
    try:
        try:
            _interruptible.append(session)
            function()
        finally:
            _interruptible.clear()
    except StepEnded:
        pass  # recorded before it was raised
    except SystemExit:
        raise  # the plug-in ends its process, and the runner shall see that
    except load.LoadError as problem:
        session.error(str(problem))
    except BaseException as problem:  # noqa: BLE001 - also KeyboardInterrupt and the plug-in's own
        # Ctrl-C in place of our handler's exception: a library set its own.
        if not (isinstance(problem, KeyboardInterrupt) and session.judge.stop_requested()):
            record_exception(session, problem)
    if os.getpid() != process:
        # A forked child came back from the plug-in; its parent serves the runner.
        _flush_output()
        session.sampling.send()
        os._exit(0)


def record_exception(session: Session, problem: BaseException) -> None:
    """Make an error of an exception, with its type, its text and where it came from.

    The text of an `rtf.Error` says it all.
    """
    place = _location.of_exception(problem.__traceback__, session.task.file)
    if isinstance(problem, Error):
        session.error(str(problem), location=place)
        return
    import traceback  # noqa: PLC0415 - slow to import, and most tests raise nothing

    reason = "".join(traceback.format_exception_only(type(problem), problem)).strip()
    if isinstance(problem, SyntaxError):
        reason = f"{type(problem).__name__}: {problem.msg}"
        place = _location.Location(problem.filename or session.task.file, problem.lineno or 0)
    trace = _location.without_host(problem.__traceback__)
    lines = traceback.format_exception(type(problem), problem, trace)
    text = f"{reason}\n{''.join(lines).rstrip()}" if trace else reason
    session.error(reason, text, location=place)


def _is_false(result: object) -> bool:
    """Whether it is `False` or what numpy has in its place."""
    return type(result).__name__ in {"bool", "bool_"} and not result


def _flush_output() -> None:
    for stream in (sys.stdout, sys.stderr):
        stream.flush()


def _answer(session: Session) -> Answer:
    _flush_output()
    session.sampling.send()
    problem = session.judge.first()
    if problem is None:
        return {"outcome": "passed"}
    outcome, reason = problem
    return {"outcome": outcome, "reason": reason}


def stop_by_signal(number: int, frame: FrameType | None) -> None:
    """Handle SIGINT: end the plug-in's function if it was sent because of a request to stop."""
    session = _session.running()
    if session is None or not session.judge.take_insistence():
        signal.default_int_handler(number, frame)
    elif _interruptible and session.judge.stop_requested():
        raise Interrupted(session.judge.stop_reason())
