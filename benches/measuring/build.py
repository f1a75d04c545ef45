"""Builds the plug-ins and programs for the measurements, with -O2 as distributions do."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from measuring.bench import TOP, Bench, tail
from measuring.model import MeasuringError

SOURCES = TOP / "benches" / "plugins"
INCLUDES = [f"-I{TOP / 'sdk' / language / 'include'}" for language in ("c", "cpp")]
C = ["cc", "-std=gnu11", "-O2"]
CPP = ["c++", "-std=c++17", "-O2"]
MODULE = ["-fPIC", "-shared"]
SIGNALS = ("Violator.py", "SignalLoad.py", "signal_rows.py")


def build(bench: Bench) -> None:
    """Builds everything into the bench's directory, in parallel."""
    for script in ("Trivial.lua", "Trivial.py", "Ticker.py", "Gate.py", "Steps.py", *SIGNALS):
        shutil.copy(SOURCES / script, bench.directory)
    commands = [
        [*C, *source("launch.c"), *output(bench, "launch")],
        [*C, *source("victim_program.c"), *output(bench, "victim")],
        [*C, *MODULE, *INCLUDES, *source("Killer.c"), *output(bench, "Killer.so")],
        [*CPP, *source("program.cpp"), *output(bench, "program")],
    ]
    for name in ("Trivial", "Fails", "Reports", "Samples", "Cases", "VictimFixture"):
        commands.append(
            [*CPP, *MODULE, *INCLUDES, *source(f"{name}.cpp"), *output(bench, f"{name}.so")]
        )
    if bench.gtest:
        libraries = ["-lgtest", "-lgtest_main", "-pthread"]
        cases = bench.directory / "cases.inc"
        count = 1000
        cases.write_text("".join(f"CASE({n})\n" for n in range(count)), encoding="ascii")
        include = f"-I{bench.directory}"
        for name, micros in (("gtest", 0), ("gtest-busy", 1000)):
            program = [*source("ManyCases.cpp"), *output(bench, name), f"-DMICROS={micros}"]
            commands.append([*CPP[:2], "-O0", include, *program, *libraries])
        counted = [*source("CountedCases.cpp"), *output(bench, "gtest-counted")]
        commands.append([*CPP, *counted, *libraries])
    if bench.predecessor:
        old = [f"-I{bench.predecessor.include}", f"-L{bench.predecessor.libraries}"]
        libraries = ["-lrobottestingframework-dll", "-lrobottestingframework"]
        plugin = [*source("Predecessor.cpp"), *output(bench, "Predecessor.so")]
        commands.append([*CPP, *MODULE, *old, *plugin, *libraries])
    with ThreadPoolExecutor() as compilers:
        list(compilers.map(compile_one, commands))


def source(name: str) -> list[str]:
    """A file in plugins/."""
    return [str(SOURCES / name)]


def output(bench: Bench, name: str) -> list[str]:
    """The arguments for an output file."""
    return ["-o", str(Path(bench.directory) / name)]


def compile_one(command: Sequence[str]) -> None:
    """Calls a compiler."""
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    if done.returncode != 0:
        raise MeasuringError(f"`{' '.join(command)}` failed:\n{tail(done.stdout)}")
