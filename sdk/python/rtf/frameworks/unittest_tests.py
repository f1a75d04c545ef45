"""The tests in a suite of unittest, which may contain suites."""

from __future__ import annotations

import inspect
import unittest

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any, Callable


def leaves(suite: Any) -> Iterator[Any]:
    """Return all tests in a suite, in order."""
    try:
        tests = iter(suite)
    except TypeError:
        yield suite
        return
    for test in tests:
        yield from leaves(test)


def retain(suite: Any, is_retained: Callable[[Any], bool]) -> None:
    """Remove tests from a suite; its own class and those of inner suites stay."""
    if not isinstance(suite, unittest.BaseTestSuite):
        return
    tests: list[Any] = list(suite)
    for test in tests:
        retain(test, is_retained)
    suite._tests = [test for test in tests if not _is_test(test) or is_retained(test)]


def _is_test(thing: Any) -> bool:
    try:
        iter(thing)
    except TypeError:
        return True
    return False


def start(test: Any) -> dict[str, object]:
    """Return what is known about a test before it runs."""
    params: dict[str, object] = {"name": test.id()}
    function = getattr(test, getattr(test, "_testMethodName", ""), None)
    code = getattr(inspect.unwrap(function), "__code__", None) if function else None
    if code is not None:
        params["location"] = {"file": code.co_filename, "line": code.co_firstlineno}
    return params


def class_name(test: Any) -> str:
    """Return the name of a test's class, as unittest reports it for `setUpClass`."""
    return f"{type(test).__module__}.{type(test).__qualname__}"
