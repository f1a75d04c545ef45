"""What the cases in Python do: each starts processes, and holds or not."""

from __future__ import annotations

import multiprocessing
import os
import re
import signal
import subprocess
import sys
from multiprocessing.context import ForkContext, SpawnContext
from pathlib import Path
from typing import NoReturn

import rtf.session

ROLE = "DESCENDANT_ROLE"
"""In the environment of a descendant: whether its cases `pass` or `fail`."""

OWN_CODE = 3


def is_descendant() -> bool:
    """Whether this process is a descendant of the tests."""
    return ROLE in os.environ


def has_passed() -> bool:
    """Whether the cases of a descendant pass."""
    return os.environ[ROLE] == "pass"


def execute(role: str, *, has_environment: bool = True) -> subprocess.CompletedProcess[str]:
    """Execute this program again with its arguments.

    Its results of rosunit are discarded: a file that two programs write is damaged.
    """
    arguments = Path("/proc/self/cmdline").read_text().split("\0")[:-1]
    arguments = [
        re.sub("^--gtest_output=.*", "--gtest_output=xml:/dev/null", it) for it in arguments
    ]
    environment = dict(os.environ) if has_environment else {}
    kept = ("PATH", "PYTHONPATH")
    environment |= {name: os.environ[name] for name in kept if name in os.environ}
    return subprocess.run(
        [sys.executable, *arguments[1:]],
        env={**environment, ROLE: role},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )


def end_of(child: int) -> int:
    """Wait for a child; its exit code, or a negative signal."""
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def executes_itself() -> bool:
    """A descendant with the same arguments passes."""
    return execute("pass").returncode == 0


def needs_a_descendant_that_fails() -> bool:
    """The case fails."""
    return execute("fail").returncode == 0


def expects_a_descendant_that_fails() -> bool:
    """A descendant fails."""
    return execute("fail").returncode == 1


def executes_itself_without_environment() -> bool:
    """A descendant has no variables of rtf."""
    return execute("pass", has_environment=False).returncode == 0


def has_an_environment_of_its_own() -> bool:
    """What rtf adds for the reporter has gone."""
    names = ("RTF_SESSION", "RTF_STACK_FILE", "RTF_LISTING")
    return not any(name in os.environ for name in names)


def forks_and_exits() -> bool:
    """A child calls `sys.exit`."""
    child = os.fork()
    if child == 0:
        sys.exit(0)
    return end_of(child) >= 0


def forks_and_exits_at_once() -> bool:
    """A child calls `os._exit`."""
    child = os.fork()
    if child == 0:
        os._exit(OWN_CODE)
    return end_of(child) == OWN_CODE


def forks_and_aborts() -> bool:
    """A child dies."""
    child = os.fork()
    if child == 0:
        os.abort()
    return end_of(child) == -signal.SIGABRT


def forks_and_returns() -> bool:
    """A child continues with the other cases."""
    child = os.fork()
    if child == 0:
        os.environ[ROLE] = "pass"
        return True
    return end_of(child) >= 0


def forks_and_fails() -> bool:
    """The same, and its case fails."""
    child = os.fork()
    if child == 0:
        os.environ[ROLE] = "pass"
        return False
    return end_of(child) >= 0


def work(number: int) -> int:
    """A task of a worker."""
    print("a worker prints", flush=True)
    return number * 2


def die(_number: int) -> NoReturn:
    """A task in which a worker exits."""
    sys.exit(OWN_CODE)


def uses_workers(context: SpawnContext | ForkContext) -> bool:
    """Use processes of `multiprocessing`."""
    with context.Pool(2) as pool:
        doubled = pool.map(work, range(4))
    process = context.Process(target=die, args=(1,))
    process.start()
    process.join()
    return doubled == [0, 2, 4, 6] and process.exitcode == OWN_CODE


def spawns_workers() -> bool:
    """Workers are executed."""
    return uses_workers(multiprocessing.get_context("spawn"))


def forks_workers() -> bool:
    """Workers are forked."""
    return uses_workers(multiprocessing.get_context("fork"))


def reports_from_a_fork() -> bool:
    """A child measures, which has a result for the child with and without rtf."""
    child = os.fork()
    if child == 0:
        session = rtf.session.current()
        os._exit(0 if session.measure("speed", 1.0, high=2.0) else 1)
    return end_of(child) == 0


def passes() -> bool:
    """Nothing starts."""
    return True


def fails() -> bool:
    """Nothing starts, and the case fails."""
    return False


DEEDS = (
    executes_itself,
    needs_a_descendant_that_fails,
    expects_a_descendant_that_fails,
    executes_itself_without_environment,
    has_an_environment_of_its_own,
    forks_and_exits,
    forks_and_exits_at_once,
    forks_and_aborts,
    forks_and_returns,
    forks_and_fails,
    spawns_workers,
    forks_workers,
    reports_from_a_fork,
    passes,
    fails,
)


def holds(name: str) -> bool:
    """Whether a case holds. In a descendant, all cases have the same result."""
    if is_descendant():
        return has_passed()
    return next(deed for deed in DEEDS if deed.__name__ == name)()
