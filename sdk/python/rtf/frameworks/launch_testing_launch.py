"""The launches of a file of launch_testing, run by launch_testing's own runner."""

from __future__ import annotations

import functools
import signal

from launch import launch_service
from launch_testing import test_runner
from launch_testing.loader import LoadTestsFromPythonModule

from rtf.frameworks.launch_testing_reporter import Reporter, case_start

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType
    from typing import Any

_FORWARDED = (
    "startTest",
    "stopTest",
    "addError",
    "addFailure",
    "addSkip",
    "addExpectedFailure",
    "addUnexpectedSuccess",
    "addSubTest",
)


def load(module: ModuleType) -> list[Any]:
    """Return the launches of a module, named as `launch_test` does.

    Raises what launch_testing and the user's functions raise if these do not fit together.
    """
    name = module.__name__
    runs: list[Any] = LoadTestsFromPythonModule(module, name=f"{name}.{name}.launch_tests")
    test_runner.LaunchTestRunner(runs).validate()
    return runs


def starts(runs: list[Any]) -> Iterator[dict[str, object]]:
    """Return what is known about each test before it runs."""
    return (case_start(test, run) for run in runs for test in run.all_cases())


def is_successful(runs: list[Any], arguments: list[str], reporter: Reporter | None = None) -> bool:
    """Run launches one after the other, and whether all tests passed."""
    if reporter is not None:
        test_runner.TestResult = _forwarding(test_runner.TestResult, reporter)
        _make_stoppable()
    results = test_runner.LaunchTestRunner(runs, arguments).run()
    if reporter is not None:
        for run, result in results.items():
            reporter.finish_run(run, result)
    return all(result.wasSuccessful() for result in results.values())


def _forwarding(base: type[Any], reporter: Reporter) -> type[Any]:
    """Return launch_testing's class of results, whose calls also arrive at the reporter."""

    def forward(name: str) -> Any:
        @functools.wraps(getattr(base, name))
        def function(self: Any, *args: Any) -> None:
            # First, because unittest removes its own frames from the traceback.
            if not reporter.is_closed:
                getattr(reporter, name)(*args)
            getattr(base, name)(self, *args)
            self.shouldStop |= reporter.shouldStop

        return function

    return type(base.__name__, (base,), {name: forward(name) for name in _FORWARDED})


def _make_stoppable() -> None:
    """Let SIGTERM shut a launch down. launch would end, and leave its processes."""
    services: list[Any] = []

    class Service(test_runner.LaunchService):  # type: ignore[misc]
        def run(self, **options: Any) -> Any:
            services.append(self)
            return super().run(**options)

    class SignalManager(launch_service.AsyncSafeSignalManager):  # type: ignore[misc]
        def handle(self, number: Any, handler: Any) -> Any:
            def shut_down(_number: Any) -> None:
                services[-1].shutdown(force_sync=True)

            is_stop = number == signal.SIGTERM and handler is not None
            return super().handle(number, shut_down if is_stop else handler)

    test_runner.LaunchService = Service
    launch_service.AsyncSafeSignalManager = SignalManager
