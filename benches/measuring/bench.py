"""Finds and starts the programs of the measurements."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from measuring.model import MeasuringError

TOP = Path(__file__).resolve().parents[2]
PREDECESSOR = "robot-testing-framework 2.x"
LAST_LINES = 20


@dataclass(frozen=True)
class Child:
    """An ended process."""

    seconds: float
    rss_mb: float
    """The largest resident set of the process or of one that it waited for."""
    status: int
    """The wait status."""


@dataclass(frozen=True)
class Launched:
    """The measurements of `launch`."""

    seconds: float
    children: list[Child]
    output: str


@dataclass(frozen=True)
class Predecessor:
    """An unpacked robot-testing-framework 2.x."""

    runner: Path
    include: Path
    libraries: Path

    @staticmethod
    def find() -> Predecessor | None:
        """Finds it in the directory `RTF_BENCH_PREDECESSOR`, in Debian's layout."""
        directory = os.environ.get("RTF_BENCH_PREDECESSOR")
        if not directory:
            return None
        system = Path(directory) / "usr"
        library = next(system.glob("lib/**/librobottestingframework.so"))
        runner = system / "bin" / "robottestingframework-testrunner"
        header = next(system.glob("include/**/robottestingframework/TestCase.h"))
        return Predecessor(runner, header.parents[1], library.parent)

    def environment(self) -> Mapping[str, str]:
        """The variables with which its runner finds libraries and plug-in loaders."""
        return {"LD_LIBRARY_PATH": str(self.libraries)}


@dataclass(frozen=True)
class Bench:
    """A directory with the plug-ins and helper programs, and the programs to measure."""

    directory: Path
    results: Path
    """rtf's results directory."""
    rtf: Path
    predecessor: Predecessor | None
    ctest: str
    pytest: str
    """pytest with pytest-forked, from `RTF_BENCH_PYTHON`."""
    gtest: bool
    """Whether GoogleTest's headers are installed."""

    @staticmethod
    def open(directory: Path, results: Path, rtf: Path) -> Bench:
        """Creates a bench in an empty directory."""
        if not rtf.exists():
            raise MeasuringError(f"{rtf} is missing: build it with `make build`")
        ctest = shutil.which("ctest") or ""
        pytest = shutil.which("pytest", path=os.environ.get("RTF_BENCH_PYTHON", "")) or ""
        gtest = Path("/usr/include/gtest/gtest.h").exists()
        return Bench(directory, results, rtf, Predecessor.find(), ctest, pytest, gtest)

    def launch(
        self,
        command: Sequence[str],
        count: int = 1,
        codes: Sequence[int] = (0,),
        settings: Mapping[str, str] | None = None,
    ) -> Launched:
        """Runs and measures a command `count` times, with additional variables. Each process
        must exit with one of the codes.
        """
        times = self.directory / "times"
        log = self.directory / "log"
        with log.open("wb") as output:
            stopwatch = [str(self.directory / "launch"), str(count), str(times), *command]
            done = subprocess.run(
                stopwatch,
                cwd=self.directory,
                env={**self.environment(), **(settings or {})},
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                check=False,
            )
        printed = log.read_text(encoding="utf-8", errors="replace")
        if done.returncode != 0:
            raise MeasuringError(f"cannot launch {command[0]}:\n{tail(printed)}")
        launched = parse(times.read_text(encoding="ascii"), printed)
        for child in launched.children:
            code = os.WEXITSTATUS(child.status) if os.WIFEXITED(child.status) else -1
            if code not in codes:
                raise MeasuringError(
                    f"`{' '.join(command)}` ended with wait status {child.status}:\n{tail(printed)}"
                )
        return launched

    def environment(self) -> Mapping[str, str]:
        """The user's environment without variables of rtf. Tests use this interpreter,
        because a shim in front of it would be measured, too.
        """
        kept = {name: value for name, value in os.environ.items() if not name.startswith("RTF_")}
        return {**kept, "RTF_PYTHON": sys.executable, "NO_COLOR": "1"}


def parse(times: str, printed: str) -> Launched:
    """Parses the result of `launch`."""
    total, *rest = times.splitlines()
    children = []
    for entry in rest:
        nanoseconds, kib, status = entry.split()
        children.append(Child(int(nanoseconds) / 1e9, int(kib) * 1024 / 1e6, int(status)))
    return Launched(int(total) / 1e9, children, printed)


def tail(printed: str) -> str:
    """The end of an output."""
    return "\n".join(printed.splitlines()[-LAST_LINES:])
