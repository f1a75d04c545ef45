"""Runs a case with the predecessor and with rtf, and returns both outcomes."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

SECONDS = 60


@dataclass(frozen=True)
class Side:
    """One of the two programs: its installation, and the project that was built against it."""

    prefix: Path
    build: Path
    is_ours: bool

    def environment(self, log: Path) -> dict[str, str]:
        """The environment for the programs of this side."""
        environment = os.environ | {"BENCH_LOG": str(log)}
        environment.pop("RTF_PLUGIN_PATH", None)
        if not self.is_ours:
            libraries = sorted(self.prefix.glob("lib/*-linux-*"))
            environment["LD_LIBRARY_PATH"] = ":".join(map(str, libraries))
        return environment

    def test(self, param: str) -> str:
        """The outcome of the plug-in Endings with these parameters, and its log."""
        plugin = str(self.build / "plugins" / "Endings.so")
        options = ["--param", param, "--environment", "--robot simulator"]
        if self.is_ours:
            return self._run([self._program("rtf"), "run", plugin, *options])
        program = self._program("robottestingframework-testrunner")
        return self._run([program, "--verbose", "--no-output", "--test", plugin, *options])

    def suite(self, elements: str) -> str:
        """The same of a suite; its plug-ins are named `Endings`, `Rig`, `Whole` and `libplain`."""
        for name in ("Endings", "Rig", "Whole", "libplain"):
            elements = elements.replace(f">{name}<", f">{self.build}/plugins/{name}.so<")
        with tempfile.TemporaryDirectory() as directory:
            file = Path(directory) / "suite.xml"
            file.write_text(f"<suite name='suite'>{elements}</suite>")
            if self.is_ours:
                return self._run([self._program("rtf"), "run", str(file)])
            program = self._program("robottestingframework-testrunner")
            return self._run([program, "--verbose", "--no-output", "--suite", str(file)])

    def embedded(self, scenario: str) -> list[str]:
        """The output of a program that runs tests in its own process."""
        command = [str(self.build / "embed"), scenario]
        with tempfile.TemporaryDirectory() as directory:
            environment = self.environment(Path(directory) / "log")
            ran = subprocess.run(
                command,
                env=environment,
                capture_output=True,
                text=True,
                timeout=SECONDS,
                check=False,
            )
        ended = "died" if ran.returncode < 0 else "ended"
        return [*(line.rstrip() for line in ran.stdout.splitlines()), ended]

    def _program(self, name: str) -> str:
        return str(self.prefix / "bin" / name)

    def _run(self, command: list[str]) -> str:
        with tempfile.TemporaryDirectory() as name:
            directory = Path(name)
            log = directory / "log"
            ran = subprocess.run(
                command,
                env=self.environment(log),
                cwd=directory,
                capture_output=True,
                text=True,
                timeout=SECONDS,
                errors="replace",
                check=False,
            )
            verdicts = journal(directory) if self.is_ours else console(ran.stdout)
            if ran.returncode < 0:
                verdicts = ["the runner died"]
            elif ran.returncode > 1:
                verdicts.append(f"exit code {ran.returncode}")
            color = "green" if ran.returncode == 0 else "red"
            logged = log.read_text().splitlines() if log.exists() else []
        return " | ".join([color, ", ".join(verdicts), ", ".join(logged)])


def console(text: str) -> list[str]:
    """The verdicts in the predecessor's output, which has failures and errors."""
    verdicts = []
    first = ""
    for line in re.sub(r"\x1b\[[0-9]*m", "", text).splitlines():
        if line.startswith("[FAIL]") and not first:
            first = "failed"
        elif line.startswith("[ERROR]") and not first:
            first = "error"
        elif re.match("Test case .* passed!", line):
            verdicts.append("passed")
            first = ""
        elif re.match("Test case .* failed!", line):
            verdicts.append(first or "failed")
            first = ""
        elif re.match("Test case .* started", line):
            first = ""
    return verdicts


def journal(directory: Path) -> list[str]:
    """The verdicts in the newest journal of a directory; none if nothing was started."""
    file = directory / "rtf-results" / "latest" / "events.jsonl"
    if not file.exists():
        return []
    events = [json.loads(line) for line in file.read_text().splitlines()]
    verdicts = [event["verdict"] for event in events if event["type"] == "test-finished"]
    return verdicts + ["skipped" for event in events if event["type"] == "test-skipped"]


def build(project: Path, directory: Path, package: str) -> None:
    """Builds a CMake project against an installed package."""
    if directory.exists():
        shutil.rmtree(directory)
    configure = [
        "cmake",
        "-S",
        str(project),
        "-B",
        str(directory),
        "-DCMAKE_BUILD_TYPE=Debug",
        package,
    ]
    subprocess.run(configure, check=True)
    subprocess.run(["cmake", "--build", str(directory), "--parallel", "2"], check=True)
