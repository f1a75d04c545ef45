"""``python -m rtf`` without an installed runner."""

import os
import subprocess
import sys
from pathlib import Path

SDK = Path(__file__).resolve().parents[1]


def test_the_missing_runner_is_named(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(SDK), "PATH": ""}
    command = [sys.executable, "-m", "rtf", "--version"]
    ended = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 1
    assert ended.stderr.startswith("error: the program `rtf` is neither in the installation of ")
    assert "hint: pip install robot-testing-framework" in ended.stderr


def test_the_runner_of_the_prefix_gets_the_arguments_and_the_interpreter(tmp_path: Path) -> None:
    module = tmp_path / "lib/python3/site-packages/rtf"
    module.mkdir(parents=True)
    (module / "__init__.py").touch()
    (module / "__main__.py").write_text((SDK / "rtf/__main__.py").read_text())
    runner = tmp_path / "bin/rtf"
    runner.parent.mkdir()
    runner.write_text('#!/bin/sh\necho "$@" "$RTF_PYTHON"\n')
    runner.chmod(0o755)
    environment = {**os.environ, "PYTHONPATH": str(module.parent)}
    environment.pop("RTF_PYTHON", None)
    command = [sys.executable, "-m", "rtf", "run", "a b"]
    output = subprocess.check_output(command, cwd=tmp_path, env=environment, text=True)
    assert output == f"run a b {sys.executable}\n"
