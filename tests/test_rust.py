"""The tests of the Rust crates, which cargo runs, and what runs their code in other builds."""

from __future__ import annotations

import json
import os

import pytest
from checkout import TARGET, call, need_packages, output_of


def targets(part: str) -> list[str]:
    """Options of cargo: the end-to-end tests, all others, or those in the documentation."""
    if part != "crates":
        return {"e2e": ["--test", "e2e"], "documentation": ["--doc"]}[part]
    metadata = json.loads(output_of("cargo", "metadata", "--no-deps", "--format-version=1"))
    found = {
        f"--{target['kind'][0]}={target['name']}"
        for package in metadata["packages"]
        for target in package["targets"]
        if target["test"] and target["kind"][0] in {"bin", "test"}
    }
    return ["--lib", *sorted(found - {"--test=e2e"})]


@pytest.mark.first(30)
# An interpreter without the user's packages starts in a third of the time, thousands of times.
@pytest.mark.venv("test")
@pytest.mark.usefixtures("debug_rtf")
@pytest.mark.parametrize("part", ["e2e", "crates", "documentation"])
def test_workspace(part: str) -> None:
    """All crates; `cargo test -p CRATE NAME` runs one test."""
    # Many tests wait for processes, so more of them than processors run at the same time. `nohup`
    # passes an ignored SIGHUP on, and `rtf` respects it; some tests send SIGHUP.
    threads = str(3 * (os.cpu_count() or 1))
    command = "env --default-signal=HUP cargo test --workspace --locked --no-fail-fast"
    call(*command.split(), *targets(part), RUST_TEST_THREADS=threads)


@pytest.mark.first
@pytest.mark.usefixtures("rtf")
def test_fuzz() -> None:
    """The libraries again, with libFuzzer's counters and the dependencies of the release build."""
    call("tools/fuzz.sh", "--seconds", "10", "--seed", "1")


@pytest.mark.first
@pytest.mark.usefixtures("debug_rtf")
def test_sanitizers() -> None:
    """GCC's; those with valgrind take minutes, and `make sanitizers` runs all."""
    call("tools/sanitizers.sh", "sanitizer")


@pytest.mark.usefixtures("rtf")
def test_instruction_counts() -> None:
    call("tools/counts.py", TARGET / "release/rtf-counts")


@pytest.mark.usefixtures("debug_rtf")
def test_history_in_postgresql() -> None:
    """With a server, which the test starts and ends."""
    need_packages("postgresql")
    bin_dir = output_of("bash", "-c", "ls -d /usr/lib/postgresql/*/bin | sort -V | tail -n 1")
    # All crates, although one is tested: with the features of all of them, nothing is built twice.
    command = "cargo test --quiet --locked --workspace --test postgres -- --ignored"
    call(*command.split(), RTF_POSTGRES_BIN=bin_dir)
