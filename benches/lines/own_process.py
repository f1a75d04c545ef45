"""1000 trivial tests in C++ and Lua, with a process each or a shared one."""

from __future__ import annotations

from collections.abc import Callable

from measuring import suite
from measuring.bench import PREDECESSOR, Bench, Launched
from measuring.model import Group, Limit, Line, Samples, Work

COUNT = 1000
UNIT = "ms a test"

SPAWN = "posix_spawn + wait of /bin/true"
CTEST = "ctest"
PREDECESSOR_CPP = "predecessor in process, C++"
PREDECESSOR_LUA = "predecessor in process, Lua"
CPP = "rtf, C++"
LUA = "rtf, Lua"
CPP_SHARED = "rtf, C++, shared"
LUA_SHARED = "rtf, Lua, shared"


def group(bench: Bench) -> Group:
    """The predecessor is the peer of shared hosts, because it runs all tests in its process."""
    no_predecessor = "" if bench.predecessor else f"{PREDECESSOR} is missing"
    works = (
        Work(SPAWN, lambda: a_test(bench.launch(["/bin/true"], COUNT))),
        Work(CTEST, ctest(bench), "" if bench.ctest else "ctest is not installed"),
        Work(PREDECESSOR_CPP, predecessor(bench, "dll", "./Predecessor.so"), no_predecessor),
        Work(PREDECESSOR_LUA, predecessor(bench, "lua", "Trivial.lua"), no_predecessor),
        Work(CPP, rtf(bench, "dll")),
        Work(LUA, rtf(bench, "lua")),
        Work(CPP_SHARED, rtf(bench, "dll", "shared")),
        Work(LUA_SHARED, rtf(bench, "lua", "shared")),
    )
    twice = Limit(2.0, of_ratio=True)
    at_par = Limit(1.0, of_ratio=True, required=False)
    near_bare = Limit(1.2, of_ratio=True, required=False)
    below_ctest = Limit(0.4, of_ratio=True, required=False)
    lines = (
        Line(f"{COUNT} C++ tests, own process each", CPP, UNIT, SPAWN, twice),
        Line(f"{COUNT} C++ tests, own process each: goal", CPP, UNIT, SPAWN, at_par),
        Line(f"{COUNT} C++ tests, compared with ctest", CPP, UNIT, CTEST, below_ctest),
        Line(f"{COUNT} C++ tests, shared", CPP_SHARED, UNIT, PREDECESSOR_CPP, at_par),
        Line(f"{COUNT} Lua tests, own process each", LUA, UNIT, SPAWN, near_bare),
        Line(f"{COUNT} Lua tests, shared", LUA_SHARED, UNIT, PREDECESSOR_LUA, at_par),
        Line(f"{COUNT} bare processes", SPAWN, UNIT),
    )
    return Group("own process", works, lines)


def a_test(launched: Launched) -> Samples:
    """The time per test."""
    return {UNIT: [launched.seconds * 1e3 / COUNT]}


def rtf(bench: Bench, kind: str, isolation: str = "process") -> Callable[[], Samples]:
    """Runs the tests with rtf."""
    elements = suite.tests(kind, "Trivial", COUNT, isolation)
    file = suite.write(bench, f"trivial-{kind}-{isolation}", elements)
    return lambda: a_test(suite.run_passing(bench, file, COUNT))


def predecessor(bench: Bench, kind: str, plugin: str) -> Callable[[], Samples]:
    """Runs them with the predecessor, which does not support names of tests."""
    elements: list[str] = [f'<test type="{kind}">{plugin}</test>'] * COUNT
    file = suite.write(bench, f"predecessor-{kind}", elements)
    return lambda: a_test(suite.run_predecessor(bench, file, COUNT))


def ctest(bench: Bench) -> Callable[[], Samples]:
    """Runs a C++ program as often with ctest, from a file in CMake's format."""
    directory = bench.directory / "ctest"
    directory.mkdir(exist_ok=True)
    program = bench.directory / "program"
    entries = "".join(f'add_test("test-{n:06}" "{program}")\n' for n in range(COUNT))
    (directory / "CTestTestfile.cmake").write_text(entries, encoding="utf-8")
    return lambda: a_test(bench.launch([bench.ctest, "--test-dir", str(directory)]))
