"""A small package with the interface of ROS 2's `launch_testing`, which no registry has."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from typing import Any


def post_shutdown_test() -> Callable[[type[Any]], type[Any]]:
    """The tests of the class run when the processes have ended."""

    def decorate(tests: type[Any]) -> type[Any]:
        tests.__post_shutdown_test__ = True
        return tests

    return decorate


def parametrize(names: str, values: list[Any]) -> Callable[[Any], Any]:
    """Launches once for each value."""
    argument_names = [name.strip() for name in names.split(",")]

    def decorate(describe: Any) -> Any:
        def launches() -> Iterator[tuple[Any, dict[str, Any]]]:
            for value in values:
                row = value if isinstance(value, tuple) else (value,)
                arguments = dict(zip(argument_names, row, strict=True))
                launch = functools.partial(describe, **arguments)
                yield functools.update_wrapper(launch, describe), arguments

        launches.__parametrized__ = True
        return launches

    return decorate


def ready_to_test_action_timeout(seconds: float) -> Callable[[Any], Any]:
    """How long a launch may take until it is ready."""

    def decorate(describe: Any) -> Any:
        describe.__ready_to_test_action_timeout__ = seconds
        return describe

    return decorate
