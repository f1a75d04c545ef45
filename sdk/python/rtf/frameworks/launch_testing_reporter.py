"""Reports the results of launch_testing, and the processes that it launches, to the host."""

from __future__ import annotations

import os
import signal
import time

from launch.actions import RegisterEventHandler, Shutdown
from launch.event_handlers import OnProcessExit, OnProcessIO
from launch_testing.test_result import FailResult, SkipResult

from rtf.frameworks import unittest_result, unittest_tests

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from rtf.frameworks.connection import Connection
    from rtf.session import Session

# The group of the cases that run when all processes have ended.
_GROUP = "post-shutdown"

# How much of the output of each process is added to a case that failed.
_OUTPUT_LINES = 50
_OUTPUT_BYTES = 16_384


class Reporter(unittest_result.Reporter):
    """Reports tests. Those that need the processes run in a second thread."""

    def __init__(self, connection: Connection, session: Session, file: str) -> None:
        """Report the tests of this file."""
        super().__init__(connection, session)
        # Whether it shuts the launch down when a process ends with an error.
        self.stops_on_exit = False
        # Whether the launch has ended before its tests, of which one may still run.
        self.is_closed = False
        self._file = os.path.abspath(file)
        self._starts: dict[str, dict[str, object]] = {}
        self._running: str | None = None
        self._has_problem = False
        # What each process has printed while the case runs.
        self._outputs: dict[str, bytes] = {}
        self._launched = 0.0
        self._is_ready = False
        # How processes ended during the launch.
        self._exits: list[str] = []

    def select(self, runs: list[Any]) -> list[Any]:
        """Announce the tests of all launches. Returns the launches of which tests run."""
        for run in runs:
            starts = ((case_name(test), case_start(test, run)) for test in run.all_cases())
            self._starts.update(starts)
            run.normalized_test_description = self._watched(run.normalized_test_description)
        selected = self.plan([test for run in runs for test in run.all_cases()])
        for run in runs:
            if not run.pre_shutdown_tests.countTestCases():
                text = "no test runs before the shutdown: processes end as soon as they are ready"
                self._message("report", text)
            for suite in (run.pre_shutdown_tests, run.post_shutdown_tests):
                unittest_tests.retain(suite, lambda test: selected[case_name(test)])
        return [run for run in runs if any(True for _ in run.all_cases())]

    def is_stopped(self) -> bool:
        """Whether the runner stops the test."""
        return self._stop.is_requested

    def finish_run(self, run: Any, result: Any) -> None:
        """Report the tests of a launch that did not run."""
        names = [case_name(test) for test in run.all_cases()]
        if isinstance(result, SkipResult):
            reason = next((reason for _, reason in result.skipped), "") or "skipped"
            for name in self._start_waiting(names):
                finished = {"name": name, "outcome": "skipped", "reason": reason}
                self._connection.post("case-finished", finished)
        elif isinstance(result, FailResult) and not self.is_stopped():
            self.is_closed = True
            running = [self._running] if self._running in names else []
            for name in [*running, *self._start_waiting(names)]:
                reason = self._early_end(run, "while the test ran" if running == [name] else "")
                self._message("failure", reason, name)
                if running == [name]:
                    self._report_outputs()
                self._connection.post("case-finished", {"name": name})

    # The functions of unittest's reporter

    def name(self, test: Any) -> str:  # noqa: D102
        return case_name(test)

    def start(self, test: Any) -> dict[str, object]:  # noqa: D102
        return self._starts[case_name(test)]

    def file(self, test: Any) -> str:  # noqa: D102
        return self._file

    def startTest(self, test: Any) -> None:  # noqa: D102, N802
        self._running, self._has_problem = case_name(test), False
        self._outputs.clear()
        super().startTest(test)

    def stopTest(self, test: Any) -> None:  # noqa: D102, N802
        if self._has_problem:
            self._report_outputs()
        super().stopTest(test)
        self._running = None

    def _message(self, kind: str, text: str, case: str | None = None, **more: object) -> None:
        self._has_problem |= kind != "report" and case == self._running
        super()._message(kind, text, case, **more)

    # The launch

    def _report_outputs(self) -> None:
        """Add what the processes have printed to the running case."""
        for process, output in list(self._outputs.items()):
            lines = output.decode("utf-8", "replace").splitlines()[-_OUTPUT_LINES:]
            text = "\n".join([f"output of `{process}`:", *lines])
            self._message("report", text, self._running)

    def _watched(self, describe: Any) -> Any:
        """Return a function that describes a launch, and observes when it is ready."""

        def described(*, ready_fn: Any) -> Any:
            def ready() -> None:
                self._is_ready = True
                ready_fn()

            self._launched, self._is_ready = time.monotonic(), False
            self._exits.clear()
            description, objects = describe(ready_fn=ready)
            # launch calls the newest handlers first, so these before those of launch_testing,
            # which let a test continue that waits for the end of a process.
            description.entities[:0] = self._handlers()
            return description, objects

        return described

    def _handlers(self) -> list[Any]:
        """Return what observes the processes of a launch."""
        return [
            RegisterEventHandler(OnProcessExit(on_exit=self._on_exit)),
            RegisterEventHandler(OnProcessIO(on_stdout=self._on_output, on_stderr=self._on_output)),
        ]

    def _on_output(self, event: Any) -> None:
        if self._running is not None:
            output = self._outputs.get(event.process_name, b"") + event.text
            self._outputs[event.process_name] = output[-_OUTPUT_BYTES:]

    def _on_exit(self, event: Any, context: Any) -> Any:
        if context.is_shutdown:
            return None
        text = f"process `{event.process_name}` {_ending(event.returncode)}"
        self._exits.append(text)
        if not self.stops_on_exit or event.returncode == 0:
            self._message("report", text, self._running)
            return None
        self._message("failure", text, self._running)
        return Shutdown(reason=text)

    def _early_end(self, run: Any, when: str) -> str:
        if self._is_ready:
            text = f"the launch ended {when or 'before the test'}"
        elif time.monotonic() - self._launched >= run.timeout:
            text = f"the launch was not ready to test within {run.timeout:g} s"
        else:
            text = "the launch ended before it was ready to test"
        return "; ".join([text, *self._exits])

    def _start_waiting(self, names: list[str]) -> list[str]:
        """Start the tests that have not run."""
        waiting = [name for name in names if self._pending.pop(name, None)]
        for name in waiting:
            self._connection.post("case-started", self._starts[name])
        return waiting


def case_name(test: Any) -> str:
    """Return the name of a case: `Class.test[parameter]`."""
    name = f"{type(test).__qualname__}.{test._testMethodName}"
    is_late = getattr(type(test), "__post_shutdown_test__", False)
    return f"{_GROUP}/{name}" if is_late else name


def case_start(test: Any, run: Any) -> dict[str, object]:
    """Return what is known about a test before it is launched."""
    parameters = [{"name": name, "value": str(value)} for name, value in run.param_args.items()]
    start = {**unittest_tests.start(test), "name": case_name(test)}
    return {**start, "parameters": parameters} if parameters else start


def _ending(code: int) -> str:
    if code >= 0:
        return f"exited with code {code}"
    try:
        return f"was killed by {signal.Signals(-code).name}"
    except ValueError:
        return f"was killed by signal {-code}"
