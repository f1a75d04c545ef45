"""Finds the tests of a module, and what is launched for them."""

from __future__ import annotations

import functools
import inspect
import unittest
from collections.abc import Iterator
from typing import Any

from .actions import ReadyToTest


class TestRun:
    """One launch, and its tests."""

    def __init__(self, name: str, describe: Any, arguments: dict[str, Any], module: Any) -> None:
        self.name, self.param_args = name, arguments
        self._test_description_function = describe
        self.timeout = getattr(describe, "__ready_to_test_action_timeout__", 15)
        self.markers = getattr(describe, "__markers__", {})
        self.pre_shutdown_tests = _Loader(is_late=False).loadTestsFromModule(module)
        self.post_shutdown_tests = _Loader(is_late=True).loadTestsFromModule(module)
        for suite in (self.pre_shutdown_tests, self.post_shutdown_tests):
            _keep_tests(suite)
        for test in self.all_cases():
            if arguments:
                method = getattr(test, test._testMethodName)
                test._testMethodName += f"[{', '.join(map(str, arguments.values()))}]"
                setattr(test, test._testMethodName, method)

    def all_cases(self) -> Iterator[Any]:
        """All tests, in order."""
        yield from _tests(self.pre_shutdown_tests)
        yield from _tests(self.post_shutdown_tests)

    def normalized_test_description(self, *, ready_fn: Any) -> tuple[Any, dict[str, Any]]:
        """Returns what is launched, and objects for the tests."""
        described = self._test_description_function()
        description, objects = described if isinstance(described, tuple) else (described, {})
        ready = next(_actions(description, ReadyToTest), None)
        if ready is None:
            raise Exception(
                "generate_test_description functions must return "
                "a LaunchDescription containing a ReadyToTest action"
            )
        ready.callbacks.append(ready_fn)
        return description, objects

    @staticmethod
    def bind(tests: Any, objects: dict[str, Any]) -> None:
        """Passes objects to the tests that have arguments of these names."""
        for test in _tests(tests):
            for name in (test._testMethodName, "setUp", "tearDown"):
                function = getattr(test, name)
                names = inspect.signature(function).parameters
                matching = {key: value for key, value in objects.items() if key in names}
                setattr(test, name, functools.partial(function, **matching))


def LoadTestsFromPythonModule(module: Any, *, name: str) -> list[TestRun]:
    """Returns the launches of a module."""
    describe = module.generate_test_description
    launches = describe() if hasattr(describe, "__parametrized__") else [(describe, {})]
    return [TestRun(name, function, arguments, module) for function, arguments in launches]


class _Loader(unittest.TestLoader):
    def __init__(self, *, is_late: bool) -> None:
        super().__init__()
        self._is_late = is_late

    def loadTestsFromTestCase(self, tests: type[Any]) -> unittest.TestSuite:
        if getattr(tests, "__post_shutdown_test__", False) != self._is_late:
            return self.suiteClass()
        # Each launch has separate classes.
        copied = type(tests.__name__, (tests,), {"__module__": tests.__module__})
        return super().loadTestsFromTestCase(copied)


def _keep_tests(suite: Any) -> None:
    """Lets a suite have its tests also when they have run."""
    if isinstance(suite, unittest.TestSuite):
        suite._removeTestAtIndex = lambda _: None  # type: ignore[method-assign]
        for each in suite:
            _keep_tests(each)


def _tests(suite: Any) -> Iterator[Any]:
    if isinstance(suite, unittest.TestSuite):
        for each in suite:
            yield from _tests(each)
    else:
        yield suite


def _actions(entity: Any, kind: type[Any]) -> Iterator[Any]:
    for action in getattr(entity, "entities", []):
        if isinstance(action, kind):
            yield action
        yield from _actions(action, kind)
