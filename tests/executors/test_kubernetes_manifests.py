"""What `rtf … --executor kubernetes --executor-print` prints, and the schemas of Kubernetes.

The schemas are those of all versions that rtf supports.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest
from checkout import call, output_of, venv

Manifest = dict[str, Any]

VERSIONS = ["1.29", "1.33", "1.37"]
SUITE = """<suite name="arm" requires="robot:arm">
  <test>Passes.lua</test><test>Passes.lua</test>
</suite>"""
CAMPAIGN = """<campaign suite="arm.xml" episodes="10">
  <parameter name="load" distribution="uniform" low="0" high="1"/>
  <claim require="rate >= 0.5" confidence="0.9"/>
</campaign>"""
PATCH = """\
metadata: {labels: {team: grasping}}
spec:
  backoffLimitPerIndex: 1
  template:
    spec:
      nodeSelector: {gpu: "yes"}
      containers:
        - name: rtf
          env: [{name: ROS_DOMAIN_ID, value: "7"}]
          resources: {requests: {memory: 2Gi}}
          volumeMounts: [{name: shared, mountPath: /shared}]
      volumes: [{name: shared, emptyDir: {}}]
"""
OPTIONS = ["--executor", "kubernetes", "--executor-image", "robot-tests:1", "--executor-print"]


RUN = ["run", "arm.xml", "--shard-by", "count", "--no-history"]
COMMANDS = {
    "run": [*RUN, "--executor-claim", "results"],
    "patched": [*RUN, "--executor-patch", "patch.yaml", "--executor-licenses"],
    "campaign": ["campaign", "run", "campaign.xml", "--executor-claim", "results"],
}


@pytest.fixture
def directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A directory with a suite, a campaign and a patch, and `kubectl` on PATH."""
    programs = output_of("tests/executors/control_plane/build.sh")
    monkeypatch.setenv("PATH", f"{programs}:{os.environ['PATH']}")
    (tmp_path / "Passes.lua").write_text("function TestCase.run() end\n")
    (tmp_path / "arm.xml").write_text(SUITE)
    (tmp_path / "campaign.xml").write_text(CAMPAIGN)
    (tmp_path / "patch.yaml").write_text(PATCH)
    return tmp_path


def printed(rtf: str, directory: Path, name: str) -> Manifest:
    """The manifest that a command prints."""
    command = [rtf, *COMMANDS[name], *OPTIONS, "--shards", "2"]
    done = subprocess.run(command, check=True, cwd=directory, stdout=subprocess.PIPE)
    manifest: Manifest = json.loads(done.stdout)
    spec = manifest["spec"]
    assert (spec["completions"], spec["completionMode"]) == (2, "Indexed")
    return manifest


@pytest.mark.parametrize("name", COMMANDS)
def test_manifest_is_valid(rtf: str, directory: Path, name: str) -> None:
    file = directory / "manifest.json"
    file.write_text(json.dumps(printed(rtf, directory, name)))
    script = Path(__file__).with_name("validate_manifest.py")
    call(venv("kubernetes") / "python", script, file, *VERSIONS)


def test_options_are_in_the_manifest(rtf: str, directory: Path) -> None:
    run = printed(rtf, directory, "run")
    pod = run["spec"]["template"]["spec"]
    assert pod["volumes"] == [
        {"name": "results", "persistentVolumeClaim": {"claimName": "results"}}
    ]
    (container,) = pod["containers"]
    results = str(directory / "rtf-results")
    assert container["volumeMounts"] == [{"name": "results", "mountPath": results}]
    assert container["workingDir"] == str(directory)
    assert run["spec"]["backoffLimitPerIndex"] == 3


def test_patch_is_in_the_manifest(rtf: str, directory: Path) -> None:
    patched = printed(rtf, directory, "patched")
    assert patched["metadata"]["labels"]["app.kubernetes.io/name"] == "rtf"
    assert patched["spec"]["backoffLimitPerIndex"] == 1
    pod = patched["spec"]["template"]["spec"]
    (container,) = pod["containers"]
    limits = {"limits": {"rtf/robot_arm": "1"}, "requests": {"memory": "2Gi"}}
    assert (container["image"], container["resources"]) == ("robot-tests:1", limits)
    assert pod["nodeSelector"] == {"gpu": "yes"}


def test_manifest_of_a_campaign(rtf: str, directory: Path) -> None:
    campaign = printed(rtf, directory, "campaign")
    (container,) = campaign["spec"]["template"]["spec"]["containers"]
    assert container["command"][4] == "campaign-task"
