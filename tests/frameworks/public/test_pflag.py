"""Compares rtf with `go test` case by case, for a public module that knows nothing of rtf."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from checkout import output_of
from observed import observe
from run import Run

MODULE = "github.com/spf13/pflag@v1.0.10"
VERDICTS = {"pass": "passed", "fail": "failed", "skip": "skipped"}
AT_LEAST = 100


def test_the_tests_of_a_go_module_have_the_verdicts_of_go_test(
    rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", f"{output_of('tools/go.sh')}:{os.environ['PATH']}")
    monkeypatch.setenv("RTF_PLUGIN_PATH", str(tmp_path))
    package = tmp_path / "pflag"
    copy_module(package)
    expected = results_of_go(package)
    suite = str(Path(__file__).with_name("pflag.xml"))
    run = Run(rtf, suite, tmp_path / "results")
    code = run.wait()
    got = {path: case.verdict for path, case in observe(run.events())["pflag"].cases.items()}
    assert got == expected
    assert (code == 0) == ("failed" not in expected.values())
    assert len(expected) >= AT_LEAST


def copy_module(package: Path) -> None:
    """Downloads the module, unless Go has it, and makes a copy that can be written to."""
    download = ["go", "mod", "download", "-json", MODULE]
    environment = {**os.environ, "GOWORK": "off"}
    done = subprocess.run(
        download, cwd=package.parent, env=environment, stdout=subprocess.PIPE, check=True
    )
    shutil.copytree(json.loads(done.stdout)["Dir"], package)
    for path in (package, *package.rglob("*")):
        path.chmod(path.stat().st_mode | 0o200)


def results_of_go(package: Path) -> dict[str, str]:
    """The verdicts of all tests and subtests by name."""
    command = ["go", "test", "-json", "-count=1"]
    done = subprocess.run(command, cwd=package, stdout=subprocess.PIPE, text=True, check=False)
    events = [json.loads(line) for line in done.stdout.splitlines()]
    ends = [event for event in events if "Test" in event and event["Action"] in VERDICTS]
    return {event["Test"]: VERDICTS[event["Action"]] for event in ends}
