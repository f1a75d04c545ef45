#!/usr/bin/env python3
"""Validates what `rtf … --executor kubernetes --executor-print` prints with kubernetes-validate.

    manifests.py RTF PROGRAMS

PROGRAMS is a directory with `kubectl`. The schemas are those of all versions that rtf supports.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import kubernetes_validate
from waiting import equal, expect

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


def main() -> int:
    """Validates all manifests."""
    rtf, programs = str(Path(sys.argv[1]).resolve()), sys.argv[2]
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name).resolve()
        (directory / "Passes.lua").write_text("function TestCase.run() end\n")
        (directory / "arm.xml").write_text(SUITE)
        (directory / "campaign.xml").write_text(CAMPAIGN)
        (directory / "patch.yaml").write_text(PATCH)

        def printed(*verb: str, options: list[str]) -> dict[str, Any]:
            command = [rtf, *verb, *OPTIONS, "--shards", "2", *options]
            path = f"{programs}:{os.environ['PATH']}"
            done = subprocess.run(
                command,
                check=True,
                cwd=directory,
                capture_output=True,
                env=os.environ | {"PATH": path},
            )
            manifest: dict[str, Any] = json.loads(done.stdout)
            return manifest

        run = ("run", "arm.xml", "--shard-by", "count", "--no-history")
        manifests = [
            printed(*run, options=["--executor-claim", "results"]),
            printed(*run, options=["--executor-patch", "patch.yaml", "--executor-licenses"]),
            printed("campaign", "run", "campaign.xml", options=["--executor-claim", "results"]),
        ]
        check_contents(manifests, directory)
    for manifest in manifests:
        for version in VERSIONS:
            kubernetes_validate.validate(manifest, version, strict=True)
        misspelt = json.loads(
            json.dumps(manifest).replace("podFailurePolicy", "podFailurePolicies")
        )
        expect(not is_valid(misspelt), "a misspelt field is valid")
    print(f"ok  {len(manifests)} manifests, Kubernetes {', '.join(VERSIONS)}")
    return 0


def check_contents(manifests: list[dict[str, Any]], directory: Path) -> None:
    """The options and the patch are in the manifests."""
    run, patched, campaign = manifests
    for manifest in manifests:
        equal((manifest["spec"]["completions"], manifest["spec"]["completionMode"]), (2, "Indexed"))
    pod = run["spec"]["template"]["spec"]
    claim = {"name": "results", "persistentVolumeClaim": {"claimName": "results"}}
    equal(pod["volumes"], [claim])
    (container,) = pod["containers"]
    mounts = [{"name": "results", "mountPath": str(directory / "rtf-results")}]
    equal((container["volumeMounts"], container["workingDir"]), (mounts, str(directory)))
    equal(run["spec"]["backoffLimitPerIndex"], 3)

    equal(patched["metadata"]["labels"]["app.kubernetes.io/name"], "rtf")
    equal(patched["spec"]["backoffLimitPerIndex"], 1)
    pod = patched["spec"]["template"]["spec"]
    (container,) = pod["containers"]
    limits = {"limits": {"rtf/robot_arm": "1"}, "requests": {"memory": "2Gi"}}
    equal((container["image"], container["resources"]), ("robot-tests:1", limits))
    equal(pod["nodeSelector"], {"gpu": "yes"})
    (container,) = campaign["spec"]["template"]["spec"]["containers"]
    equal(container["command"][4], "campaign-task")


def is_valid(manifest: dict[str, Any]) -> bool:
    """Whether the newest schema permits a manifest."""
    try:
        kubernetes_validate.validate(manifest, VERSIONS[-1], strict=True)
    except kubernetes_validate.ValidationError:
        return False
    return True


if __name__ == "__main__":
    os.environ.pop("RTF_RESULTS", None)
    sys.exit(main())
