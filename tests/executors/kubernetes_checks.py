"""Checks of `--executor kubernetes` in separate namespaces: part of test_kubernetes.py.

    unshare --mount --pid --fork --mount-proc --kill-child kubernetes_checks.py RTF PROGRAMS

PROGRAMS is the directory that control_plane/build.sh prints. Runs the checks whose names it reads,
one after the other in the same cluster, and prints `passed` or `failed` after each. All processes
end with this one. The results directory is a mount that only this process and the pods with the
volume see. The checks of campaigns are in kubernetes_campaigns.py.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import kubernetes_campaigns
from cluster_campaigns import Campaigns
from cluster_project import TESTS, Executor, Project, stored
from kubernetes_cluster import CLAIM, IMAGE, NAMESPACE, Cluster
from waiting import commands, equal, expect, finish, finish_with_output, until

PATCH = """\
spec:
  template:
    spec:
      containers:
        - name: rtf
          env:
            - name: NODE
              valueFrom: {fieldRef: {fieldPath: spec.nodeName}}
          resources: {requests: {cpu: 900m}}
"""
# The fixture does not end by SIGTERM.
STUCK = """<suite name="stuck">
  <fixture name="stuck" type="process">
    <command>sh -c "trap '' TERM; while true; do sleep 1; done"</command>
    <stop signal="SIGTERM" grace="9m"/>
  </fixture>
  <test>waits.lua</test>
</suite>"""
# The hook fails after the tests of the other tasks have started.
HOOKED = """<suite name="hooked">
  <hook on="end"><command>false</command></hook>
  <test>others.lua</test>
</suite>"""
OTHERS = """function TestCase.run()
  local function started()
    local count = 0
    local file = io.open(os.getenv("RTF_PARAM_DIR") .. "/started")
    if file then
      for _ in file:lines() do count = count + 1 end
    end
    return count
  end
  while started() < 3 do rtf.sleep(0.05) end
end
"""


def main() -> None:
    """Runs the checks whose names are on standard input."""
    rtf, programs = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    with (
        tempfile.TemporaryDirectory() as directory,
        Cluster(programs, Path(directory).resolve(), rtf) as cluster,
    ):
        for line in sys.stdin:
            try:
                with project_directory(cluster) as project:
                    CHECKS[line.strip()](cluster, project)
                result = "passed"
            except Exception:
                traceback.print_exc()
                cluster.print_logs()
                result = "failed"
            cluster.clean()
            print(result, flush=True)


@contextmanager
def project_directory(cluster: Cluster) -> Iterator[Path]:
    """A directory in which the results are the volume."""
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory).resolve()
        (path / "patch.yaml").write_text(PATCH)
        results = path / "rtf-results"
        results.mkdir()
        subprocess.run(["mount", "--bind", str(cluster.volume), str(results)], check=True)
        try:
            yield path
        finally:
            subprocess.run(["umount", str(results)], check=True)


def executor(cluster: Cluster, user: str = "submitter", image: str = IMAGE) -> Executor:
    """The options of the executor."""
    options = ["--executor", "kubernetes", "--executor-image", image, "--executor-claim", CLAIM]
    options += [f"--executor-arg=--namespace={NAMESPACE}", "--executor-patch", "patch.yaml"]
    return Executor(options, cluster.environment(user))


def of_suite(check: Callable[[Cluster, Project], None]) -> Callable[[Cluster, Path], None]:
    """A check with a project."""

    def run(cluster: Cluster, directory: Path) -> None:
        check(cluster, Project(str(cluster.rtf), directory, executor(cluster)))

    return run


def of_campaign(check: Callable[[Cluster, Campaigns], None]) -> Callable[[Cluster, Path], None]:
    """A check with campaigns."""

    def run(cluster: Cluster, directory: Path) -> None:
        check(cluster, Campaigns(str(cluster.rtf), directory, executor(cluster)))

    return run


def wait_for_tests(project: Project, count: int) -> None:
    """Waits until tests run."""
    until(f"{count} tests have started", lambda: len(project.started()) == count)


def nothing_is_left(cluster: Cluster, directory: Path) -> None:
    """Neither a job nor a pod nor a process is left."""
    equal((cluster.objects("jobs"), cluster.objects("pods")), ([], []))
    equal(commands(lambda command: str(directory) in command), {})


def verdicts(_: Cluster, project: Project) -> None:
    """The same verdicts and exit code as a local run, in one merged run."""
    local = subprocess.run(
        project.command("arm.xml"), check=False, cwd=project.dir, capture_output=True
    )
    expected = stored(project)
    process = project.start("arm.xml", "--report", "junit=junit.xml", "--symlink", "newest")
    errors = finish(process, local.returncode)
    equal(stored(project), expected)
    equal(len(expected), TESTS)
    expect("4 of 4 tasks ended, 0 running, 0 waiting; 12 of 12 tests finished" in errors, errors)
    # Failed tests are no failure of a pod that another one would repeat.
    expect("failed" not in errors, errors)
    equal(len(list(project.submission().glob("parts/*/*"))), 4)
    equal((project.dir / "junit.xml").read_text().count("<testcase"), TESTS)


def by_hand(cluster: Cluster, project: Project) -> None:
    """A printed job that the user submits is followed."""
    output, errors = finish_with_output(project.start("arm.xml", "--executor-print"), 0)
    equal(cluster.objects("jobs"), [])
    (project.dir / "job.json").write_text(output)
    job = json.loads(output)
    equal(job["spec"]["completionMode"], "Indexed")
    cluster.kubectl("create", "--namespace", NAMESPACE, "--filename", str(project.dir / "job.json"))
    resume = [project.rtf, "run", "--resume", str(project.submission())]
    finish(project.executor.start(resume, Path("/")), 1)
    equal(len(stored(project)), TESTS)
    expect(str(project.submission()) in errors, errors)


def resources(cluster: Cluster, project: Project) -> None:
    """Tasks that need the only robot never run at the same time."""
    process = project.start("robot.xml", "--executor-licenses")
    wait_for_tests(project, 1)
    until("the others wait", lambda: len(cluster.pods("Pending")) == 3)
    equal(project.started(), ["n1"])
    project.go()
    errors = finish(process, 0)
    expect("a task waits: Unschedulable: 0/2 nodes are available" in errors, errors)
    equal(project.started(), ["n1"] * 4)


def evicted(cluster: Cluster, project: Project) -> None:
    """The tasks of a node that is drained run again: a disruption is no failure."""
    process = project.start("slow.xml")
    wait_for_tests(project, 4)
    cluster.kubectl("drain", "n2", "--force")
    until("two tasks wait", lambda: len(cluster.pods("Pending")) == 2)
    project.go()
    errors = finish(process, 0)
    equal(stored(project), dict.fromkeys("ABCD", "passed"))
    attempts = project.submission().glob("parts/*/*")
    equal(sorted(attempt.name for attempt in attempts), ["0", "0", "0", "0", "1", "1"])
    expect("was ended: EvictionByEvictionAPI" in errors, errors)


def failed_hook(cluster: Cluster, project: Project) -> None:
    """Exit code 4 ends the job, and the other tasks tear down."""
    (project.dir / "hooked.xml").write_text(HOOKED)
    (project.dir / "others.lua").write_text(OTHERS)
    project.suite("slow", dict.fromkeys("ABC", "waits"))
    errors = finish(project.start("slow.xml", "hooked.xml"), 4)
    expect("PodFailurePolicy: " in errors, errors)
    equal(stored(project), dict.fromkeys("ABC", "interrupted") | {"others": "passed"})
    equal(cluster.pods("Running"), [])


def cancelled(cluster: Cluster, project: Project) -> None:
    """Ctrl-C leaves no job and no process, and the results of what ran."""
    process = project.start("slow.xml")
    wait_for_tests(project, 4)
    process.send_signal(signal.SIGINT)
    finish(process, 130)
    nothing_is_left(cluster, project.dir)
    equal(set(stored(project).values()), {"interrupted"})


def cancelled_twice(cluster: Cluster, project: Project) -> None:
    """A second Ctrl-C kills tasks whose tear-down takes too long."""
    (project.dir / "stuck.xml").write_text(STUCK)
    process = project.start("stuck.xml", "--shutdown-timeout", "10m")
    wait_for_tests(project, 1)
    process.send_signal(signal.SIGINT)
    until("the job is deleted", lambda: "deletionTimestamp" in str(cluster.objects("jobs")))
    equal(len(cluster.pods("Running")), 1)

    def interrupted_again() -> bool:
        # Signals within half a second are one request.
        process.send_signal(signal.SIGINT)
        return process.poll() is not None

    until("it has ended", interrupted_again)
    finish(process, 130)
    nothing_is_left(cluster, project.dir)


def resumed(cluster: Cluster, project: Project) -> None:
    """Another process merges the submission of a killed one."""
    process = project.start("slow.xml", "--report", "junit=junit.xml")
    wait_for_tests(project, 4)
    process.kill()
    process.communicate()
    equal(len(cluster.pods("Running")), 4)
    resume = [project.rtf, "run", "--resume", str(project.submission())]
    follower = project.executor.start(resume, Path("/"))
    project.go()
    finish(follower, 0)
    equal(len(stored(project)), 4)
    equal((project.dir / "junit.xml").read_text().count("<testcase"), 4)


def no_image(cluster: Cluster, project: Project) -> None:
    """An image that cannot be pulled is reported, and the job can be cancelled."""
    project.executor = executor(cluster, image="missing:1")
    process = project.start("arm.xml")
    lines: list[str] = []
    assert process.stderr
    while "ErrImagePull" not in (line := process.stderr.readline()):
        expect(line != "", "".join(lines))
        lines.append(line)
    expect("a task waits: ErrImagePull: no such image: missing:1" in line, line)
    process.send_signal(signal.SIGINT)
    finish(process, 130)
    nothing_is_left(cluster, project.dir)


def no_script(cluster: Cluster, project: Project) -> None:
    """A container that cannot start is reported with what it printed, and is not repeated."""
    command = "command: [sh, /missing]\n          "
    (project.dir / "patch.yaml").write_text(PATCH.replace("env:", f"{command}env:"))
    errors = finish(project.start("arm.xml"), 5)
    expect(
        re.search("exit code (2|127), and is not repeated: .*missing", errors) is not None, errors
    )
    expect("error: task 1 died: it has no journal" in errors, errors)
    equal(cluster.pods("Running"), [])


def refusals(cluster: Cluster, project: Project) -> None:
    """What cannot work is refused with a hint before anything is submitted."""
    allowed = project.executor
    project.executor = executor(cluster, user="stranger")
    errors = finish(project.start("arm.xml"), 2)
    expect("`kubectl create` failed: Error from server (Forbidden)" in errors, errors)
    project.executor = Executor(allowed.options, dict(os.environ) | {"PATH": str(project.dir)})
    errors = finish(project.start("arm.xml"), 2)
    expect("cannot execute `kubectl" in errors and "hint: install `kubectl`" in errors, errors)
    project.executor = allowed
    (project.dir / "patch.yaml").write_text("spec: [")
    errors = finish(project.start("arm.xml"), 2)
    expect("`kubectl patch` failed" in errors, errors)
    (project.dir / "patch.yaml").write_text("spec: {template: {spec: {nodeSelectors: {a: b}}}}")
    errors = finish(project.start("arm.xml"), 2)
    expect('unknown field "spec.template.spec.nodeSelectors"' in errors, errors)
    equal(cluster.objects("jobs"), [])
    equal(list((project.dir / "rtf-results/.submissions").iterdir()), [])


SUITES = [
    verdicts,
    by_hand,
    resources,
    evicted,
    failed_hook,
    cancelled,
    cancelled_twice,
    resumed,
    no_image,
    no_script,
    refusals,
]
CHECKS = {check.__name__: of_suite(check) for check in SUITES} | {
    check.__name__: of_campaign(check) for check in kubernetes_campaigns.CHECKS
}


if __name__ == "__main__":
    os.environ.pop("RTF_RESULTS", None)
    main()
