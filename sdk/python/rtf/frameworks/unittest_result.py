"""Reports unittest's results to the host as cases."""

from __future__ import annotations

import re
import sys
import traceback
import unittest
from _thread import get_ident
from time import perf_counter_ns

from rtf.frameworks.comparison import compared
from rtf.frameworks.stop import Stop
from rtf.frameworks.unittest_tests import class_name, import_problem, start

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import TracebackType
    from typing import Any

    from rtf.frameworks.connection import Connection
    from rtf.session import Session

# The name of the "test" that fails with a function for several tests.
_GROUP = re.compile(r"(setUpClass|setUpModule|tearDownClass|tearDownModule) \((.*)\)")

# What `assertAlmostEqual` does without `places`.
_DEFAULT_PLACES = 7


class Stopped(BaseException):
    """The runner stops the test. Not an `Exception`, so that tests do not catch it."""


class Reporter(unittest.TestResult):
    """Reports the results of tests."""

    STOPPED = Stopped

    def __init__(self, connection: Connection, session: Session) -> None:
        """Report to this connection."""
        super().__init__()
        self._connection = connection
        self._session = session
        self._stop = Stop(Stopped)
        # Between tests, an exception would end the run without `tearDownClass`.
        self._stop.raises = False
        self._main_thread = get_ident()
        # Planned tests that have not started: their start, by name.
        self._pending: dict[str, list[Any]] = {}
        # The result of the running test, unless its messages decide it.
        self._result: dict[str, object] = {}
        self._started = 0

    def plan(self, tests: list[Any]) -> dict[str, bool]:
        """Announce tests. Returns for each name whether it runs."""
        runs = self._connection.plan([self.name(test) for test in tests])
        for test in tests:
            name = self.name(test)
            if runs[name]:
                self._pending.setdefault(name, []).append(_Pending(test, self.start(test)))
        return runs

    def name(self, test: Any) -> str:
        """Return the name of a test's case."""
        return str(test.id())

    def start(self, test: Any) -> dict[str, object]:
        """Return what is known about a test before it runs."""
        return start(test)

    def file(self, test: Any) -> str:
        """Return the file of a test, or nothing."""
        module = sys.modules.get(type(test).__module__)
        return getattr(module, "__file__", None) or ""

    def report_import_problem(self, text: str) -> None:
        """Report a module that cannot be imported."""
        short, long = import_problem(text)
        self._message("error", short)
        self._message("report", long)

    def finish(self) -> None:
        """Everything is reported."""
        self._session.send_samples()
        self._connection.post("finished", {})

    # The functions of `TestResult`

    def startTest(self, test: Any) -> None:  # noqa: N802 - unittest's name
        """Start a case."""
        super().startTest(test)
        self._start(self.name(test), self.start(test))
        self._started = perf_counter_ns()
        self._stop.raises = get_ident() == self._main_thread

    def stopTest(self, test: Any) -> None:  # noqa: N802
        """Finish a case. After a stop request, the runner finishes it."""
        self._stop.raises = False
        super().stopTest(test)
        self._session.send_samples()
        if self._stop.is_requested:
            self.stop()
        else:
            duration = (perf_counter_ns() - self._started) // 1000
            params = {"name": self.name(test), "duration_us": duration, **self._result}
            self._connection.post("case-finished", params)

    def addError(self, test: Any, err: Any) -> None:  # noqa: N802
        """Report an exception, also of a function for several tests."""
        # First, because unittest removes its own frames from the traceback.
        self._problem("error", test, err)
        super().addError(test, err)

    def addFailure(self, test: Any, err: Any) -> None:  # noqa: N802
        """Report a failed assertion."""
        self._problem("failure", test, err)
        super().addFailure(test, err)

    def addSkip(self, test: Any, reason: str) -> None:  # noqa: N802
        """Skip a test, a subtest, or all tests of a class or a module."""
        super().addSkip(test, reason)
        skip: dict[str, object] = {"outcome": "skipped", "reason": reason or "skipped"}
        group = _GROUP.fullmatch(test.id())
        if group is not None:
            for name in self._take_group(*group.groups()):
                self._connection.post("case-finished", {"name": name, **skip})
        elif hasattr(test, "test_case"):
            path = self._start_subtest(test)
            self._connection.post("case-finished", {"name": path, **skip})
        else:
            self._result = skip

    def addExpectedFailure(self, test: Any, err: Any) -> None:  # noqa: N802
        """Report a failure that is expected."""
        super().addExpectedFailure(test, err)
        short = _short(err)
        self._message("report", self._long(err, test), self.name(test))
        self._result = {"outcome": "skipped", "reason": f"expected failure: {short}"}

    def addUnexpectedSuccess(self, test: Any) -> None:  # noqa: N802
        """Report a test that should have failed."""
        super().addUnexpectedSuccess(test)
        location = self.start(test).get("location")
        self._message("failure", "unexpected success", self.name(test), location=location)

    def addSubTest(self, test: Any, subtest: Any, err: Any) -> None:  # noqa: N802
        """Report a subtest, which has ended."""
        if not self._stop.is_requested:
            path = self._start_subtest(subtest)
            if err is not None:
                is_failure = issubclass(err[0], test.failureException)
                self._exception("failure" if is_failure else "error", test, err, path)
            self._connection.post("case-finished", {"name": path})
        super().addSubTest(test, subtest, err)

    # Reports

    def _start(self, name: str, params: dict[str, object]) -> None:
        waiting = self._pending.get(name)
        if waiting:
            waiting.pop(0)
        self._result = {}
        self._connection.post("case-started", params)

    def _start_subtest(self, subtest: Any) -> str:
        parent = self.name(subtest.test_case)
        name = subtest._subDescription()
        values = [{"name": str(key), "value": str(it)} for key, it in subtest.params.items()]
        params = {"name": name, "parent": parent, "parameters": values}
        self._connection.post("case-started", params)
        return f"{parent}/{name}"

    def _problem(self, kind: str, test: Any, err: Any) -> None:
        if self._stop.is_requested:
            # The exception of the stop request, or one that it caused.
            self.stop()
            return
        group = _GROUP.fullmatch(test.id())
        if group is None:
            self._exception(kind, test, err, self.name(test))
            return
        text = f"{test.id()}: {_short(err)}"
        names: list[str | None] = [*self._take_group(*group.groups())]
        for name in names or [None]:
            self._message("error", text, name, location=_innermost(err[2]))
            self._message("report", self._long(err, test), name)
            if name is not None:
                self._connection.post("case-finished", {"name": name})

    def _take_group(self, function: str, owner: str) -> list[str]:
        """Start all waiting tests of a class or a module whose set-up ended."""
        if not function.startswith("setUp"):
            return []
        names = []
        for name, waiting in self._pending.items():
            own = [it for it in waiting if owner in {it.class_name, it.module}]
            for pending in own:
                waiting.remove(pending)
                self._connection.post("case-started", pending.start)
                names.append(name)
        return names

    def _exception(self, kind: str, test: Any, err: Any, path: str) -> None:
        details: dict[str, object] = {}
        details["location"] = _innermost(err[2], self.file(test))
        details["comparison"] = _comparison(err[2])
        self._message(kind, _short(err), path, **details)
        self._message("report", self._long(err, test), path)

    def _long(self, err: Any, test: Any) -> str:
        text = self._exc_info_to_string(err, test)  # type: ignore[attr-defined]
        return str(text)

    def _message(self, kind: str, text: str, case: str | None = None, **more: object) -> None:
        params = {"kind": kind, "text": text.rstrip(), "case": case, **more}
        self._connection.post("message", {k: v for k, v in params.items() if v is not None})


class _Pending:
    """A planned test that has not started."""

    def __init__(self, test: Any, start: dict[str, object]) -> None:
        """Keep what is needed if its class or module cannot be set up."""
        self.start = start
        self.class_name = class_name(test)
        self.module = type(test).__module__


def _short(err: Any) -> str:
    return "".join(traceback.format_exception_only(err[0], err[1])).strip()


def _innermost(trace: TracebackType | None, file: str = "") -> dict[str, object] | None:
    """Return the innermost line of `file` in a traceback, otherwise that outside unittest."""
    found = last = None
    while trace is not None:
        code = trace.tb_frame.f_code
        place: dict[str, object] = {"file": code.co_filename, "line": trace.tb_lineno}
        if code.co_filename == file:
            found = place
        if "__unittest" not in trace.tb_frame.f_globals:
            last = place
        trace = trace.tb_next
    return found or last


def _comparison(trace: TracebackType | None) -> dict[str, object] | None:
    """Return the numbers that `assertEqual` or `assertAlmostEqual` compared."""
    while trace is not None:
        frame = trace.tb_frame
        function, values = frame.f_code.co_name, frame.f_locals
        if "__unittest" in frame.f_globals and {"first", "second"} <= values.keys():
            if function == "assertEqual":
                return compared(values["first"], values["second"], 0.0)
            if function == "assertAlmostEqual":
                places = values.get("places")
                digits = _DEFAULT_PLACES if places is None else places
                tolerance = values.get("delta") or 0.5 * 10**-digits
                return compared(values["first"], values["second"], tolerance)
        trace = trace.tb_next
    return None
