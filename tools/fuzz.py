#!/usr/bin/env python3
"""Gives arbitrary inputs to everything that reads bytes of others, with libFuzzer.

fuzz.py [--seconds N | --runs N] [--jobs N] [--seed N] [--program FILE] [TARGET ...]

Each target runs for this time, or so often, with the inputs of the repository and those of
earlier runs, which are in build/fuzz. An input for which a property does not hold is stored in
build/fuzz/found, and the exit code is 1. crates/rtf-fuzz contains the targets.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "fuzz"
FOUND = BUILD / "found"
# One input may not take longer, in seconds.
INPUT_SECONDS = 60
# Longer inputs are slower and find little more.
INPUT_BYTES = 4096
# In MiB.
MEMORY = 2048
# Targets write small files.
IN_MEMORY = Path("/dev/shm")


@dataclass
class Result:
    """What a target did."""

    name: str
    executions: int
    seconds: float
    inputs: int
    problem: str


def main() -> None:
    """Builds the targets and runs them."""
    parser = argparse.ArgumentParser()
    extent = parser.add_mutually_exclusive_group()
    extent.add_argument("--seconds", type=int, default=60, help="for each target")
    extent.add_argument("--runs", type=int, default=0, help="executions of each target")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="targets at a time")
    parser.add_argument("--seed", type=int, default=0, help="0: another one each time")
    parser.add_argument("--program", type=Path, help="the compiled targets")
    parser.add_argument("targets", nargs="*", help="all without")
    options = parser.parse_args()
    program = options.program or build()
    inputs = list_targets(program)
    names = options.targets or list(inputs)
    unknown = [name for name in names if name not in inputs]
    if unknown:
        raise SystemExit(f"error: there is no target {', '.join(unknown)}")
    FOUND.mkdir(parents=True, exist_ok=True)
    extent_flag = f"-max_total_time={options.seconds}"
    if options.runs:
        extent_flag = f"-runs={options.runs}"
    flags = [extent_flag, f"-seed={options.seed}"]
    with ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(lambda name: run(program, name, inputs[name], flags), names))
    print_table(results)
    if any(result.problem for result in results):
        sys.exit(1)


def build() -> Path:
    """Compiles the targets. Only the workspace's own libraries have counters."""
    environment = {**os.environ, "RUSTC_WORKSPACE_WRAPPER": str(ROOT / "tools" / "fuzz_rustc.sh")}
    # A cache of compilers does not know this one.
    environment.pop("RUSTC_WRAPPER", None)
    # These packages, because the features of libraries are then those of tools/build.sh.
    command = ["cargo", "build", "--workspace", "--exclude", "xtask", "--locked", "--release"]
    command += ["--bin", "fuzz"]
    command += ["--features", "rtf-fuzz/libfuzzer", "--message-format", "json-render-diagnostics"]
    built = subprocess.run(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, check=True)
    messages = [json.loads(line) for line in built.stdout.splitlines()]
    programs = [
        message["executable"]
        for message in messages
        if message.get("reason") == "compiler-artifact"
        and message["target"]["name"] == "fuzz"
        and message["executable"]
    ]
    return Path(programs[0])


def list_targets(program: Path) -> dict[str, list[str]]:
    """The targets, and the directories and files with inputs of the repository."""
    listed = subprocess.run([program, "--list"], stdout=subprocess.PIPE, text=True, check=True)
    rows = [line.split("\t") for line in listed.stdout.splitlines()]
    return {name: inputs for name, *inputs in rows}


def run(program: Path, name: str, inputs: list[str], flags: list[str]) -> Result:
    """Runs a target."""
    corpus = BUILD / "corpus" / name
    corpus.mkdir(parents=True, exist_ok=True)
    prefix = FOUND / f"{name}-"
    # libFuzzer reads directories only.
    directories = [path for path in inputs if Path(path).is_dir()]
    command = [
        str(program),
        *flags,
        f"-max_len={INPUT_BYTES}",
        f"-timeout={INPUT_SECONDS}",
        f"-rss_limit_mb={MEMORY}",
        f"-artifact_prefix={prefix}",
        "-print_final_stats=1",
        "-detect_leaks=0",
        str(corpus),
        *directories,
    ]
    environment = {**os.environ, "RTF_FUZZ_TARGET": name, "RUST_BACKTRACE": "1"}
    if IN_MEMORY.is_dir():
        environment["TMPDIR"] = str(IN_MEMORY)
    log = BUILD / f"{name}.log"
    with log.open("wb") as output:
        ended = subprocess.run(
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=output,
            check=False,
        )
    text = log.read_text(errors="replace")
    return Result(
        name=name,
        executions=statistic(text, r"stat::number_of_executed_units: +(\d+)"),
        seconds=statistic(text, r"Done \d+ runs in (\d+) second"),
        inputs=len(list(corpus.iterdir())),
        problem=problem_of(text, log) if ended.returncode else "",
    )


def statistic(text: str, pattern: str) -> int:
    """The last number that matches in the output of libFuzzer; 0 without one."""
    found = re.findall(pattern, text)
    return int(found[-1]) if found else 0


def problem_of(text: str, log: Path) -> str:
    """What does not hold, and the input."""
    lines = text.splitlines()
    panics = [at for at, line in enumerate(lines) if " panicked at " in line]
    reason = " ".join(lines[at + 1] for at in panics[:1]) if panics else lines[-1]
    stored = re.findall(r"Test unit written to (\S+)", text)
    return f"{reason[:300]}\n  input: {', '.join(stored) or 'none'}; output: {log}"


def print_table(results: list[Result]) -> None:
    """Prints what the targets did, and then the problems."""
    print(f"{'target':<20} {'executions':>12} {'per second':>10} {'inputs':>7}")
    for result in results:
        rate = result.executions // max(int(result.seconds), 1)
        print(f"{result.name:<20} {result.executions:>12} {rate:>10} {result.inputs:>7}")
    for result in results:
        if result.problem:
            print(f"error: {result.name}: {result.problem}")


if __name__ == "__main__":
    main()
