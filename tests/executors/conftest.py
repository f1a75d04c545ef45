"""The private cluster of Slurm, and what runs in it."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from checkout import ROOT
from cluster_campaigns import Campaigns
from cluster_project import Executor, Project
from slurm_cluster import jobs, nodes
from waiting import until

VARIABLES = ["PATH", "SLURM_CONF", "RTF_SLURM_DIR", "RTF_SLURM_START"]
SLURM = Executor(["--executor", "slurm"])


@pytest.fixture(autouse=True)
def _results(monkeypatch: pytest.MonkeyPatch) -> None:
    """Results are in the directory of each test."""
    monkeypatch.delenv("RTF_RESULTS", raising=False)


@pytest.fixture(scope="module")
def _slurm() -> Iterator[None]:
    """The cluster of tools/slurm.sh, which needs root, and its variables."""
    printed = " ".join(f'"${name}"' for name in VARIABLES)
    command = ["tools/slurm.sh", "sh", "-c", rf"printf '%s\n' {printed} && exec cat"]
    pipe = subprocess.PIPE
    with (
        subprocess.Popen(command, cwd=ROOT, stdin=pipe, stdout=pipe, text=True) as slurm,
        pytest.MonkeyPatch.context() as environment,
    ):
        assert slurm.stdout
        for name in VARIABLES:
            value = slurm.stdout.readline().rstrip("\n")
            assert value, "the cluster does not start"
            environment.setenv(name, value)
        yield


@pytest.fixture
def slurm_dir(_slurm: None, tmp_path: Path) -> Iterator[Path]:
    """A directory for a submission, after which the cluster becomes idle."""
    yield tmp_path
    until("the cluster is idle", lambda: not jobs() and nodes() == {"idle"})


@pytest.fixture
def project(debug_rtf: str, slurm_dir: Path) -> Project:
    """A project with suites."""
    return Project(debug_rtf, slurm_dir, SLURM)


@pytest.fixture
def campaigns(debug_rtf: str, slurm_dir: Path) -> Campaigns:
    """A project with campaigns."""
    return Campaigns(debug_rtf, slurm_dir, SLURM)
