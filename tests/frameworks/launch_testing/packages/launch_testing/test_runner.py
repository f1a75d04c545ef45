"""Launches, and runs tests while the processes run and when they have ended."""

from __future__ import annotations

import inspect
import threading
import unittest
from typing import Any

from launch import LaunchDescription, LaunchService
from launch.actions import RegisterEventHandler
from launch.event_handlers import OnProcessExit, OnProcessIO, OnProcessStart, ProcessExited

from .test_result import FailResult, SkipResult, TestResult


class _LaunchDied(Exception):
    pass


class _Processes:
    """The last event of each process, by action or name."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._events: dict[Any, Any] = {}

    def append(self, event: Any) -> None:
        with self._changed:
            self._events[event.action] = event
            self._changed.notify_all()

    def __iter__(self) -> Any:
        return iter(list(self._events.values()))

    def __getitem__(self, action: Any) -> Any:
        return self._events[action]

    def assertWaitForShutdown(self, process: Any, timeout: float = 10) -> None:
        """Waits until a process has ended."""

        def has_ended() -> bool:
            return isinstance(self._events.get(process), ProcessExited)

        with self._changed:
            has_ended = self._changed.wait_for(has_ended, timeout)
        assert has_ended, f"Timed out waiting for process '{process.cmd}' to finish"


class _Output:
    """What the processes have printed."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._texts = {"stdout": "", "stderr": ""}

    def append(self, event: Any) -> None:
        with self._changed:
            self._texts["stdout" if event.from_stdout else "stderr"] += event.text.decode()
            self._changed.notify_all()

    def assertWaitFor(self, text: str, timeout: float = 10, stream: str = "stderr") -> None:
        """Waits until a text was printed."""
        with self._changed:
            is_found = self._changed.wait_for(lambda: text in self._texts[stream], timeout)
        assert is_found, f"Waiting for output timed out: '{text}'"


class LaunchTestRunner:
    """Runs launches one after the other."""

    def __init__(
        self, test_runs: list[Any], launch_file_arguments: list[str] | None = None
    ) -> None:
        self._runs, self._arguments = test_runs, launch_file_arguments or []

    def generate_preamble(self) -> list[Any]:
        """Further actions of each launch."""
        return []

    def validate(self) -> None:
        """The arguments of the description are those of its parameters."""
        for run in self._runs:
            names = inspect.getfullargspec(inspect.unwrap(run._test_description_function)).args
            for name in names:
                if name not in run.param_args:
                    raise Exception(
                        f"generate_test_description has unexpected extra argument '{name}'"
                    )

    def run(self) -> dict[Any, Any]:
        """Returns the results of each launch."""
        results: dict[Any, Any] = {}
        for run in self._runs:
            try:
                results[run] = self._run(run)
            except unittest.SkipTest as skip:
                results[run] = SkipResult(run, str(skip))
            except _LaunchDied:
                message = "Launch stopped before the active tests finished."
                results[run] = FailResult(run, message)
                break
        return results

    def _run(self, run: Any) -> Any:
        service = LaunchService()
        ready, finished = threading.Event(), threading.Event()
        description, objects = run.normalized_test_description(ready_fn=ready.set)
        processes, output = _Processes(), _Output()
        objects = {**objects, **run.param_args, "proc_info": processes, "proc_output": output}
        run.bind(run.pre_shutdown_tests, {**objects, "launch_service": service})
        run.bind(run.post_shutdown_tests, objects)
        for argument in self._arguments:
            name, separator, value = argument.partition(":=")
            if not separator:
                raise RuntimeError(f"malformed launch argument '{argument}'")
            service.context.launch_configurations[name] = value
        handlers = [
            OnProcessStart(on_start=lambda event, _: processes.append(event)),
            OnProcessExit(on_exit=lambda event, _: processes.append(event)),
            OnProcessIO(on_stdout=output.append, on_stderr=output.append),
        ]
        observed = [*self.generate_preamble(), *map(RegisterEventHandler, handlers)]
        service.include_launch_description(LaunchDescription([*observed, *description.entities]))
        results = []

        def run_tests() -> None:
            if ready.wait(run.timeout):
                results.append(_tested(run.pre_shutdown_tests))
                finished.set()
            else:
                print("Timed out waiting for processes to start up")
            service.shutdown()

        threading.Thread(target=run_tests, daemon=True).start()
        service.run(shutdown_when_idle=not run.markers.get("keep_alive", False))
        if not finished.is_set():
            raise _LaunchDied
        late = _tested(run.post_shutdown_tests)
        first = results[0]
        for name in ("failures", "errors", "skipped", "cases"):
            getattr(first, name).extend(getattr(late, name))
        return first


def _tested(tests: unittest.TestSuite) -> Any:
    return unittest.TextTestRunner(verbosity=2, resultclass=TestResult).run(tests)
