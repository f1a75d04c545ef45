"""The time that `make build` takes from an empty directory."""

from __future__ import annotations

import shutil

from measuring.bench import TOP, Bench
from measuring.model import Group, Limit, Line, MeasuringError, Samples, Work

BUILD = "make build"
UNIT = "min"


def group(bench: Bench) -> Group:
    """One build, which takes minutes. The crates are downloaded before."""
    lines = (Line("make build from an empty directory", BUILD, UNIT, "", Limit(4, required=False)),)
    return Group("build", (Work(BUILD, lambda: build(bench)),), lines, rounds=1, warm_up=False)


def build(bench: Bench) -> Samples:
    """Everything but the page, which is the same for each directory."""
    target = bench.directory / "target"
    fetch = ["cargo", "fetch", "--locked", "--manifest-path", str(TOP / "Cargo.toml")]
    bench.launch(fetch)
    settings = {"CARGO_TARGET_DIR": str(target)}
    launched = bench.launch(["make", "-C", str(TOP), "build"], settings=settings)
    if not (target / "release" / "rtf").exists():
        raise MeasuringError(f"make build did not write {target}/release/rtf")
    shutil.rmtree(target)
    return {UNIT: [child.seconds / 60 for child in launched.children]}
