"""Trivial tests in C++ and Lua, with a process each or a shared one: a further test, and a run."""

from __future__ import annotations

from collections.abc import Callable

from measuring import suite
from measuring.bench import PREDECESSOR, Bench
from measuring.model import Group, Limit, Line, Samples, Work
from measuring.slope import FIXED, FURTHER, by_count

FEW = 1000
MANY = 10_000

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
        Work(SPAWN, counted(lambda count: bench.launch(["/bin/true"], count).seconds)),
        Work(CTEST, counted(ctest(bench)), "" if bench.ctest else "ctest is not installed"),
        Work(PREDECESSOR_CPP, predecessor(bench, "dll", "./Predecessor.so"), no_predecessor),
        Work(PREDECESSOR_LUA, predecessor(bench, "lua", "Trivial.lua"), no_predecessor),
        Work(CPP, rtf(bench, "dll")),
        Work(LUA, rtf(bench, "lua")),
        Work(CPP_SHARED, rtf(bench, "dll", "shared")),
        Work(LUA_SHARED, rtf(bench, "lua", "shared")),
    )
    twice = Limit(2.0, of_ratio=True)

    def goal(bound: float) -> Limit:
        return Limit(bound, of_ratio=True, required=False)

    lines = (
        Line("C++ test, own process", CPP, FURTHER, SPAWN, twice),
        Line("C++ test, own process: goal", CPP, FURTHER, SPAWN, goal(1.05)),
        Line("C++ test, own process, compared with ctest", CPP, FURTHER, CTEST, goal(0.4)),
        Line("C++ test, shared", CPP_SHARED, FURTHER, PREDECESSOR_CPP, goal(2.0)),
        Line("Lua test, own process", LUA, FURTHER, SPAWN, goal(1.15)),
        Line("Lua test, shared", LUA_SHARED, FURTHER, PREDECESSOR_LUA, goal(1.2)),
        Line("bare process", SPAWN, FURTHER),
        Line("C++ tests, own process: fixed cost", CPP, FIXED),
        Line("C++ tests, shared: fixed cost", CPP_SHARED, FIXED, PREDECESSOR_CPP),
        Line("Lua tests, shared: fixed cost", LUA_SHARED, FIXED, PREDECESSOR_LUA),
    )
    return Group("own process", works, lines, rounds=5, warm_up=False)


def counted(seconds: Callable[[int], float]) -> Callable[[], Samples]:
    """Measures with few and with many tests."""
    return lambda: by_count(seconds, FEW, MANY)


def rtf(bench: Bench, kind: str, isolation: str = "process") -> Callable[[], Samples]:
    """Runs the tests with rtf."""

    def seconds(count: int) -> float:
        elements = suite.tests(kind, "Trivial", count, isolation)
        file = suite.write(bench, f"trivial-{kind}-{isolation}", elements)
        return suite.run_passing(bench, file, count).seconds

    return counted(seconds)


def predecessor(bench: Bench, kind: str, plugin: str) -> Callable[[], Samples]:
    """Runs them with the predecessor, which does not support names of tests."""

    def seconds(count: int) -> float:
        elements: list[str] = [f'<test type="{kind}">{plugin}</test>'] * count
        file = suite.write(bench, f"predecessor-{kind}", elements)
        return suite.run_predecessor(bench, file, count).seconds

    return counted(seconds)


def ctest(bench: Bench) -> Callable[[int], float]:
    """Runs a C++ program as often with ctest, from a file in CMake's format."""

    def seconds(count: int) -> float:
        directory = bench.directory / "ctest"
        directory.mkdir(exist_ok=True)
        program = bench.directory / "program"
        entries = "".join(f'add_test("test-{n:06}" "{program}")\n' for n in range(count))
        (directory / "CTestTestfile.cmake").write_text(entries, encoding="utf-8")
        return bench.launch([bench.ctest, "--test-dir", str(directory)]).seconds

    return seconds
