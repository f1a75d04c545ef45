"""Executes the shell steps of the CI helpers in packaging/ as their systems do.

What the systems themselves do between the steps is replaced: the checkout, artefacts and stashes
are copies of directories. `pip install` is real; the package is a wheel that starts `rtf`.
"""

import json
import os
import shutil
import subprocess
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from checkout import ROOT, output_of, venv

PASSES = "TestCase = {}\nfunction TestCase.run() rtf.check(true, 'fine') end\n"
FAILS = (
    "TestCase = {}\nfunction TestCase.run()\n"
    "  rtf.check(false, 'the <brake> is open')\n  rtf.measure('angle', 2.5, 'rad', 1, 2)\nend\n"
)
PACKAGING = ROOT / "packaging"
# Enough tests that none of three shards is empty.
NUMBER_OF_TESTS = 12
NAME = "robot_testing_framework"
VERSION = "0.1.0"


def make_project(rtf: str, base: Path) -> "Project":
    """Make an index with a package whose program `rtf` is the one that is tested."""
    wheels = base / "wheels"
    wheels.mkdir()
    info = f"{NAME}-{VERSION}.dist-info"
    files = {
        f"{NAME}-{VERSION}.data/scripts/rtf": f'#!/bin/sh\nexec "{rtf}" "$@"\n',
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {NAME}\nVersion: {VERSION}\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    record = "".join(f"{name},,\n" for name in [*files, f"{info}/RECORD"])
    with zipfile.ZipFile(wheels / f"{NAME}-{VERSION}-py3-none-any.whl", "w") as wheel:
        for name, text in [*files.items(), (f"{info}/RECORD", record)]:
            entry = zipfile.ZipInfo(name)
            entry.external_attr = 0o100755 << 16
            wheel.writestr(entry, text)
    return Project(base, wheels, rtf)


@dataclass
class Project:
    """Where jobs run."""

    base: Path
    wheels: Path
    rtf: str

    def checkout(self, name: str) -> Path:
        """Make a fresh checkout for a job."""
        directory = self.base / name
        tests = directory / "tests"
        tests.mkdir(parents=True)
        names = [f"Joint{number}" for number in range(NUMBER_OF_TESTS - 1)]
        for test in names:
            (tests / f"{test}.lua").write_text(PASSES)
        (tests / "Brake.lua").write_text(FAILS)
        elements = "".join(f"  <test>{test}.lua</test>\n" for test in [*names, "Brake"])
        (tests / "arm.xml").write_text(f'<suite name="arm">\n{elements}</suite>\n')
        return directory

    def environment(self, **variables: str) -> dict[str, str]:
        """Return the environment of a job: nothing of this one leads to another rtf."""
        kept = ("PATH", "HOME", "LANG", "TMPDIR")
        environment = {name: os.environ[name] for name in kept if name in os.environ}
        index = {
            "PIP_NO_INDEX": "1",
            "PIP_FIND_LINKS": str(self.wheels),
            "PIP_CONFIG_FILE": os.devnull,
        }
        return environment | index | variables


def run(command: list[str], directory: Path, environment: dict[str, str], expected: int = 0) -> str:
    """Run a command; its exit code must be the expected one. Return all its output."""
    result = subprocess.run(
        command,
        cwd=directory,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=600,
        check=False,
    )
    said = f"{' '.join(command)}\n{result.stdout}"
    assert result.returncode == expected, f"exit code {result.returncode}, not {expected}: {said}"
    return result.stdout


def load_yaml(file: Path) -> Any:
    """Read a file with the library of a separate environment."""
    script = "import json, sys, yaml; print(json.dumps(yaml.safe_load(open(sys.argv[1]))))"
    return json.loads(output_of(venv("ci") / "python", "-c", script, file))


def copy_artefact(source: Path, target: Path) -> None:
    """Copy a directory without `latest`, which is a link to one of its neighbours."""
    shutil.copytree(source, target, ignore=shutil.ignore_patterns("latest"), dirs_exist_ok=True)


def check_merged(summary: str) -> None:
    """Check the summary of all tests."""
    start = f"## ❌ FAILED\n\n{NUMBER_OF_TESTS} tests in 1 suite, "
    assert summary.startswith(start), f"the summary is of another run: {summary}"
    assert f": {NUMBER_OF_TESTS - 1} passed, 1 failed" in summary, summary
    assert "the &#60;brake&#62; is open" in summary, summary
    assert "| ❌ outside |" in summary, summary
