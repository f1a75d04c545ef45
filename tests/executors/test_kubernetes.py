"""`--executor kubernetes` with Kubernetes' own control plane and nodes of node.py."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import kubernetes_checks
import pytest
from checkout import output_of

NAMESPACES = ["unshare", "--mount", "--pid", "--fork", "--mount-proc", "--kill-child"]

Cluster = subprocess.Popen[str]


@pytest.fixture(scope="module")
def cluster(rtf: str) -> Iterator[Cluster]:
    """A process that runs checks in a cluster; all processes of the cluster end with it."""
    programs = output_of("tests/executors/control_plane/build.sh")
    script = Path(__file__).with_name("kubernetes_checks.py")
    command = [*NAMESPACES, sys.executable, str(script), rtf, programs]
    pipe = subprocess.PIPE
    with subprocess.Popen(
        command, stdin=pipe, stdout=pipe, stderr=subprocess.STDOUT, text=True
    ) as process:
        yield process


@pytest.mark.first
@pytest.mark.parametrize("check", kubernetes_checks.CHECKS)
def test_kubernetes(cluster: Cluster, check: str) -> None:
    assert cluster.stdin
    assert cluster.stdout
    print(check, file=cluster.stdin, flush=True)
    line = ""
    for line in cluster.stdout:
        print(line, end="")
        if line in {"passed\n", "failed\n"}:
            break
    assert line == "passed\n"
