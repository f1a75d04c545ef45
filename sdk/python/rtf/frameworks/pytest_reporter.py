"""Reports the items of a pytest run to the host as cases."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import pytest

from rtf import session as rtf_session
from rtf.frameworks import pytest_details, pytest_options
from rtf.frameworks.comparison import is_number
from rtf.frameworks.connection import Rejected, encoded_text
from rtf.frameworks.pytest_failures import DETAILS, FailureDetails
from rtf.frameworks.pytest_options import VALUES
from rtf.frameworks.pytest_texts import (
    collection_problem,
    expected_failure,
    long_text,
    skip_reason,
    subtest_name,
)
from rtf.frameworks.pytest_worker import SELECTION_VARIABLE
from rtf.frameworks.stop import Stop

if TYPE_CHECKING:
    from collections.abc import Generator

    from rtf.frameworks.connection import Connection

_PHASES = {"setup": "set-up: ", "teardown": "tear-down: "}

# In their order.
PHASES = ("setup", "call", "teardown")


class OpenCase:
    """A case that runs."""

    def __init__(self, start: dict[str, Any], path: str | None = None) -> None:
        """Its result is that of its messages, unless a report says otherwise."""
        self.start = start
        self.path: str = start["name"] if path is None else path
        # As JSON.
        self.name = encoded_text(self.path)
        self.seconds = 0.0
        self.has_problem = False
        self.outcome: str | None = None
        self.reason: str | None = None
        # The phase in which a plug-in decided to run the item again.
        self.rerun_in: str | None = None
        self.is_set_up = False
        self.is_called = False

    def is_hidden(self) -> bool:
        """Whether pytest did not get the report of the item's call.

        The plug-in `flaky` withholds it if it runs the item again.
        """
        has_result = self.has_problem or self.outcome is not None or self.rerun_in is not None
        return self.is_set_up and not self.is_called and not has_result

    def set(self, outcome: str, reason: str) -> None:
        """Set the result; the first one counts."""
        if self.outcome is None:
            self.outcome, self.reason = outcome, reason

    def report_result(self, connection: Connection) -> None:
        """Report that it has finished."""
        seconds, has_outcome = self.seconds, self.outcome is not None and not self.has_problem
        if seconds and not has_outcome and self.rerun_in is None:
            # Most cases.
            text = f'{{"name":{self.name},"duration_us":{int(seconds * 1e6)}}}'
            connection.post_encoded("case-finished", text)
            return
        params: dict[str, object] = {"name": self.path}
        if seconds:
            params["duration_us"] = int(seconds * 1e6)
        if has_outcome:
            params["outcome"], params["reason"] = self.outcome, self.reason
        if self.rerun_in is not None:
            params["rerun"] = True
        connection.post("case-finished", params)


class Reporter(FailureDetails):
    """Reports items. With pytest-xdist, it runs in the controller."""

    def __init__(self, config: pytest.Config, connection: Connection) -> None:
        """Report to this connection."""
        super().__init__()
        self._config = config
        self._connection = connection
        self._session = rtf_session.connect(connection)
        self._stop = Stop(KeyboardInterrupt)
        self._root = str(config.rootpath)
        self._starts = pytest_details.Starts(self._root)
        # The item that runs, unless workers of pytest-xdist run them.
        self._item: pytest.Item | None = None
        # The names of their files as JSON.
        self._files: dict[str, str] = {}
        # By node id.
        self._open: dict[str, OpenCase] = {}
        # Finished, unless the same item starts again.
        self._held: dict[str, OpenCase] = {}
        # Modules that skip themselves: name and reason.
        self._skipped_modules: dict[str, str] = {}
        # Of problems whose reports have not arrived: by the item's name and the phase.
        self._details: dict[tuple[str, str | None], dict[str, object]] = {}
        self._is_planned = False
        if SELECTION_VARIABLE in os.environ:
            pytest_options.accept_part_of_coverage(config)

    # Collection

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Report collection errors, and remember modules that skip themselves."""
        if report.failed:
            text, long = collection_problem(report)
            self._connection.post("message", {"kind": "error", "text": text})
            self._connection.post("message", {"kind": "report", "text": long})
        elif report.skipped:
            self._skipped_modules[report.nodeid] = skip_reason(report)

    @pytest.hookimpl(hookwrapper=True, tryfirst=True)
    def pytest_collection_modifyitems(
        self, config: pytest.Config, items: list[pytest.Item]
    ) -> Generator[None, None, None]:
        """Plan the items that remain, and deselect those that the runner does not want."""
        yield
        runs = self._plan(self._starts.names(items))
        dropped = [item for item in items if not runs[self._starts.name_of(item)]]
        if dropped:
            items[:] = [item for item in items if runs[self._starts.name_of(item)]]
            config.hook.pytest_deselected(items=dropped)

    @pytest.hookimpl(optionalhook=True)
    def pytest_xdist_node_collection_finished(self, ids: list[str]) -> None:
        """Plan what the workers of pytest-xdist have collected: all have the same items."""
        if self._is_planned:
            return
        self._plan(ids)

    @pytest.hookimpl(optionalhook=True)
    def pytest_configure_node(self, node: Any) -> None:
        """Hand the values of fixtures to a worker of pytest-xdist."""
        node.workerinput[VALUES] = self._connection.ask("fixture-values", {}).decode()

    def _plan(self, names: list[str]) -> dict[str, bool]:
        self._is_planned = True
        skipped = list(self._skipped_modules)
        runs = self._connection.plan(names + skipped)
        for name in skipped:
            if runs[name]:
                self._connection.post("case-started", {"name": name})
                reason = self._skipped_modules[name]
                skip = {"name": name, "outcome": "skipped", "reason": reason}
                self._connection.post("case-finished", skip)
        return runs

    # Items

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> None:
        """Keep the item, and let others run it."""
        self._item = item

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """Start a case. With pytest-xdist, its first report starts it, which has its tags."""
        held = self._held.pop(nodeid, None)
        if held is not None:
            self._report_hidden(held, self._details.pop((nodeid, "call"), {}))
        item = self._item
        if item is not None:
            self._release()
            self._details.clear()
            self._start(nodeid, self._starts.of(item))

    def _report_hidden(self, case: OpenCase, details: dict[str, Any]) -> None:
        """Report an attempt of a case that a plug-in runs again without a report of it."""
        if details or self._item is None:
            # A worker of pytest-xdist does not report the problem.
            text = details.pop("text", "the attempt failed, and a plug-in withholds the reason")
            params = {"kind": "failure", "text": text, **details, "case": case.path}
            self._connection.post("message", params)
        case.rerun_in = "call"
        case.report_result(self._connection)

    def _release(self) -> None:
        """Finish the cases that do not start again."""
        for case in self._held.values():
            case.report_result(self._connection)
        self._held.clear()

    def _start(self, nodeid: str, params: dict[str, Any]) -> OpenCase:
        case = self._open[nodeid] = OpenCase(params)
        location: Any = params.get("location")
        if location is None or len(params) > 2:  # noqa: PLR2004 - and the name
            self._connection.post("case-started", params)
            return case
        # Most cases.
        file, line = location["file"], location["line"]
        name = self._files.get(file)
        if name is None:
            name = self._files[file] = encoded_text(file)
        text = f'{{"name":{case.name},"location":{{"file":{name},"line":{line}}}}}'
        self._connection.post_encoded("case-started", text)
        return case

    def pytest_runtest_makereport(self, item: pytest.Item, call: pytest.CallInfo[Any]) -> None:
        """Keep the details of a problem for its report, which pytest makes.

        Those that pytest calls first put the problem of a `unittest.TestCase` into the call.
        """
        if call.excinfo is not None:
            details = self.details_of(item, call)
            details["text"] = call.excinfo.exconly()
            self._details[item.nodeid, call.when] = details
        elif self._details:
            # Of a subtest, which did not need them.
            self._details.pop((item.nodeid, call.when), None)

    def _details_of(self, report: pytest.TestReport) -> dict[str, Any]:
        """Return the details of a report; a worker of pytest-xdist adds them to it."""
        details: dict[str, Any] | None = getattr(report, DETAILS, None)
        return self._details.pop((report.nodeid, report.when), {}) if details is None else details

    @pytest.hookimpl(trylast=True)
    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Report a phase of an item, or a subtest. Last, because pytest counts subtests."""
        case = self._open.get(report.nodeid)
        if case is None:
            start = getattr(report, DETAILS, {}).get("start", {"name": report.nodeid})
            case = self._start(report.nodeid, start)
        elif _is_next_attempt(case, report):
            case.report_result(self._connection)
            case = self._start(report.nodeid, case.start)
        context = getattr(report, "context", None)
        if context is not None:
            self._report_subtest(case, report, context)
            return
        case.is_set_up |= report.when == "setup" and report.passed
        case.is_called |= report.when == "call"
        is_plain = report.outcome == "passed" and not hasattr(report, "wasxfail")
        if is_plain and report.when != "teardown":
            # Most reports. What else they contain is in the last one of the item, too.
            case.seconds += report.duration
            return
        self._judge(case, report)
        if report.when == "teardown":
            self._report_leftovers(case, report)

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        """Finish a case."""
        self._session.send_samples()
        case = self._open.pop(nodeid, None)
        if case is not None and case.is_hidden():
            self._held[nodeid] = case
            return
        self._details.clear()
        if case is not None:
            case.report_result(self._connection)

    def _report_subtest(self, parent: OpenCase, report: pytest.TestReport, context: Any) -> None:
        name = subtest_name(context)
        values = [{"name": key, "value": str(it)} for key, it in context.kwargs.items()]
        start = {"name": name, "parent": parent.path, "parameters": values}
        self._connection.post("case-started", start)
        case = OpenCase(start, f"{parent.path}/{name}")
        self._judge(case, report)
        self._report_leftovers(case, report, with_properties=False)
        case.report_result(self._connection)

    def _judge(self, case: OpenCase, report: pytest.TestReport) -> None:
        case.seconds += report.duration
        expected = getattr(report, "wasxfail", None)
        if report.failed:
            self._report_problem(case, report)
        elif report.skipped and expected is not None:
            case.set("skipped", expected_failure(expected))
            self._message(case, "report", long_text(report))
        elif report.skipped:
            case.set("skipped", skip_reason(report))
        elif report.outcome != "passed":
            # `rerun` of pytest-rerunfailures, `retried` of pytest-retry
            case.rerun_in = report.when
            self._report_problem(case, report)
        elif expected is not None:
            self._message(case, "report", "; ".join(filter(None, ("unexpected pass", expected))))

    def _report_problem(self, case: OpenCase, report: pytest.TestReport) -> None:
        details = self._details_of(report)
        long = long_text(report)
        if report.when not in PHASES:
            # A worker of pytest-xdist died, and nothing finishes the item.
            case.set("crashed", long)
            self.pytest_runtest_logfinish(report.nodeid)
            return
        case.has_problem = True
        crash = getattr(report.longrepr, "reprcrash", None)
        short = crash.message if crash is not None else long
        # Without an exception, pytest itself fails the item: `[XPASS(strict)]`.
        kind = details.get("kind", "failure")
        params = {"kind": kind, "text": _PHASES.get(report.when or "", "") + short}
        location = details.get("location") or self._location(report, crash)
        if location is not None:
            params["location"] = location
        if "comparison" in details:
            params["comparison"] = details["comparison"]
        self._connection.post("message", {**params, "case": case.path})
        if long != short:
            self._message(case, "report", long)

    def _location(self, report: pytest.TestReport, crash: Any) -> dict[str, object] | None:
        if crash is not None:
            return {"file": os.path.join(self._root, crash.path), "line": crash.lineno}
        path, line, _ = report.location
        return None if line is None else {"file": os.path.join(self._root, path), "line": line + 1}

    def _report_leftovers(
        self, case: OpenCase, report: pytest.TestReport, *, with_properties: bool = True
    ) -> None:
        """Report captured output and properties; the last report of an item has all."""
        for heading, text in report.sections:
            if text.strip():
                self._message(case, "report", f"{heading}\n{text.rstrip()}")
        for method, params in getattr(report, DETAILS, {}).get("results", ()):
            try:
                self._connection.request(method, {**params, "case": case.path})
            except Rejected as problem:
                case.has_problem = True
                self._message(case, "error", str(problem))
        if with_properties:
            for name, value in report.user_properties:
                self._report_property(case, name, value)

    def _report_property(self, case: OpenCase, name: str, value: Any) -> None:
        if is_number(value):
            params = {"name": str(name), "value": float(value), "unit": "", "case": case.path}
            self._connection.post("measured", params)
        else:
            self._message(case, "report", f"{name}: {value}")

    def _message(self, case: OpenCase, kind: str, text: str) -> None:
        if text:
            self._connection.post("message", {"kind": kind, "text": text, "case": case.path})

    # The end

    def pytest_keyboard_interrupt(self, excinfo: pytest.ExceptionInfo[BaseException]) -> None:
        """`pytest.exit` or Ctrl-C ends open cases. At a stop request, the runner does."""
        if not self._stop.is_requested:
            reason = f"the run was ended: {excinfo.exconly()}"
            for case in self._open.values():
                case.set("error", reason)
                case.report_result(self._connection)
            self._open.clear()
            self._release()

    def pytest_internalerror(self, excrepr: object) -> None:
        """Report an error of pytest or a plug-in."""
        text = str(excrepr)
        last = text.rstrip().rpartition("\n")[2].strip()
        error = {"kind": "error", "text": f"internal error of pytest or a plug-in: {last}"}
        self._connection.post("message", error)
        self._connection.post("message", {"kind": "report", "text": text})

    def pytest_unconfigure(self) -> None:
        """Everything is reported."""
        self._session.send_samples()
        self._release()
        self._connection.post("finished", {})


def _is_next_attempt(case: OpenCase, report: pytest.TestReport) -> bool:
    """Whether a report is not of the attempt of a case that a plug-in decided to repeat."""
    if case.rerun_in not in PHASES or report.when not in PHASES:
        return False
    return PHASES.index(report.when) <= PHASES.index(case.rerun_in)
