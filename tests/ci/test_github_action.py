"""The GitHub action and its example workflow."""

import fnmatch
import re
import shutil
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from checkout import call
from ci_project import (
    NUMBER_OF_TESTS,
    PACKAGING,
    Project,
    check_merged,
    load_yaml,
    make_project,
    run,
)

EXPRESSION = re.compile(r"\$\{\{ *([^}]*?) *\}\}")
LINK = "https://github.example/artifacts/"


@dataclass
class Job:
    """A job: its checkout, its files for the runner, and the values of expressions."""

    project: Project
    directory: Path
    action: dict[str, Any]
    artefacts: Path
    values: dict[str, str] = field(default_factory=dict)
    status: int = 0

    @property
    def files(self) -> Path:
        """The directory of the files that steps write to."""
        return self.directory.with_suffix(".runner")

    def text(self, name: str) -> str:
        """Return what the steps wrote to a file of the runner."""
        path = self.files / name
        return path.read_text() if path.exists() else ""

    def expand(self, text: object) -> str:
        """Replace the expressions of a text."""
        return EXPRESSION.sub(lambda match: self.value(match[1]), str(text))

    def value(self, expression: str) -> str:
        """Return the value of `inputs.name` and its like. An unknown output is empty."""
        if expression not in self.values and not re.fullmatch(
            r"steps\.\w+\.outputs\.[\w-]+", expression
        ):
            raise AssertionError(f"the expression `{expression}` has no value")
        return self.values.get(expression, "")

    def is_skipped(self, step: dict[str, Any]) -> bool:
        """Evaluate `if`: conditions joined by `&&`."""
        conditions = str(step.get("if", "success()")).split(" && ")
        runs_always = "always()" in conditions
        for condition in conditions:
            if condition in {"always()", "success()"}:
                continue
            name, text = re.fullmatch(r"([\w.-]+) != '(.*)'", condition).groups()  # type: ignore[union-attr]
            if self.value(name) == text:
                return True
        return self.status != 0 and not runs_always

    def steps(self, steps: list[dict[str, Any]], expected: dict[str, int]) -> None:
        """Run the steps, each with its expected exit code."""
        for step in steps:
            if not self.is_skipped(step):
                self.step(step, expected)

    def step(self, step: dict[str, Any], expected: dict[str, int]) -> None:
        """Run a step of a workflow or of the action."""
        if "run" in step:
            return self.shell(step, expected.get(step.get("name", ""), 0))
        arguments = {name: self.expand(value) for name, value in step.get("with", {}).items()}
        used = step["uses"].split("@")[0]
        if used == "./packaging/action":
            inputs = {name: str(known["default"]) for name, known in self.action["inputs"].items()}
            assert arguments.keys() <= inputs.keys(), f"unknown inputs: {arguments}"
            inputs |= {"rtf-path": str(Path(self.project.rtf).parent)} | arguments
            self.values |= {f"inputs.{name}": value for name, value in inputs.items()}
            return self.steps(self.action["runs"]["steps"], expected)
        if used == "actions/upload-artifact":
            shutil.copytree(self.directory / arguments["path"], self.artefacts / arguments["name"])
            self.values[f"steps.{step['id']}.outputs.artifact-url"] = LINK + arguments["name"]
        elif used == "actions/download-artifact":
            for artefact in self.artefacts.iterdir():
                if fnmatch.fnmatch(artefact.name, arguments["pattern"]):
                    shutil.copytree(artefact, self.directory / arguments["path"] / artefact.name)
        else:
            assert used == "actions/checkout", f"unknown action `{used}`"
        return None

    def shell(self, step: dict[str, Any], expected: int) -> None:
        """Run a shell step as GitHub's runner does."""
        script = self.files / "script.sh"
        self.files.mkdir(exist_ok=True)
        script.write_text(self.expand(step["run"]))
        names = {"OUTPUT": "output", "STEP_SUMMARY": "summary", "PATH": "path", "ENV": "env"}
        variables = {f"GITHUB_{name}": str(self.files / file) for name, file in names.items()}
        variables |= {name: self.expand(value) for name, value in step.get("env", {}).items()}
        environment = self.project.environment(
            RUNNER_TEMP=str(self.files),
            GITHUB_ACTIONS="true",
            GITHUB_WORKSPACE=str(self.directory),
            **variables,
        )
        added = self.text("path").split()
        environment["PATH"] = ":".join([*reversed(added), environment["PATH"]])
        options = (
            ["--noprofile", "--norc", "-eo", "pipefail"] if step.get("shell") == "bash" else ["-e"]
        )
        (self.files / "output").write_text("")
        run(["bash", *options, str(script)], self.directory, environment, expected)
        self.status = self.status or expected
        for line in self.text("output").splitlines():
            name, value = line.split("=", 1)
            self.values[f"steps.{step['id']}.outputs.{name}"] = value


@pytest.fixture
def project(rtf: str, tmp_path: Path) -> Project:
    """A project with robot tests."""
    return make_project(rtf, tmp_path)


@pytest.fixture(scope="module")
def action() -> dict[str, Any]:
    """The action."""
    return dict(load_yaml(PACKAGING / "action/action.yml"))


def test_the_example_is_a_valid_workflow() -> None:
    call("tools/actionlint.sh", PACKAGING / "action/example.yml")


def test_the_action_installs_runs_uploads_and_writes_the_summary(
    project: Project, action: dict[str, Any]
) -> None:

    def job(name: str, status: int = 0, **inputs: str) -> Job:
        directory = project.checkout(name)
        made = Job(project, directory, action, project.base / f"{name}.artefacts")
        again(made, status, **inputs)
        return made

    def again(job: Job, status: int, **inputs: str) -> None:
        job.status = 0
        job.values = {}
        step = {"uses": "./packaging/action", "with": inputs}
        job.step(step, {"Run the tests": status})

    installed = {"rtf-path": "", "version": "0.1.0"}
    failed = job("failed", 1, args="-r tests", **installed)
    assert "/rtf/bin\n" in failed.text("path"), "the package was installed"
    check_merged(failed.text("summary"))
    assert f"[results](<{LINK}robot-tests>)" in failed.text("summary"), "the summary has a link"
    assert (failed.directory / "junit.xml").exists(), "the JUnit report"
    assert (failed.artefacts / "robot-tests" / "events.jsonl").exists(), "the artefact is the run"

    passed = job("passed", args="tests/arm.xml -E 'name(=Joint1) | name(=Joint2)'", junit="")
    assert passed.text("summary").startswith("## ✅ PASSED\n\n2 tests "), passed.text("summary")
    assert not (passed.directory / "junit.xml").exists(), "no JUnit report"

    # The run of an earlier step is not that of a step that starts none.
    shutil.rmtree(passed.artefacts)
    again(passed, 2, args="tests/missing.xml")
    assert "rtf started no run" in passed.text("summary"), passed.text("summary")
    assert not passed.artefacts.exists(), "nothing is uploaded"
    again(passed, 1, args="tests -E 'name(Joint1)")
    only = job("only")
    assert only.text("summary") == "", "without arguments, nothing is run"


def test_the_example_merges_three_shards(project: Project, action: dict[str, Any]) -> None:
    workflow = load_yaml(PACKAGING / "action/example.yml")
    artefacts = project.base / "artefacts"
    jobs = workflow["jobs"]
    failed = 0
    shards = jobs["test"]["strategy"]["matrix"]["shard"]
    for shard in shards:
        job = Job(project, project.checkout(f"shard-{shard}"), action, artefacts)
        job.values["matrix.shard"] = str(shard)
        output = run(
            [project.rtf, "list", "-r", "tests", "--shard", f"{shard}/3"],
            job.directory,
            project.environment(),
        )
        status = int("Brake" in output)
        failed += status
        job.steps(jobs["test"]["steps"], {"Run the tests": status})
    assert failed == 1, "one shard has the failed test"
    assert len(list(artefacts.iterdir())) == len(shards), f"{NUMBER_OF_TESTS} tests fill all shards"
    merge = Job(project, project.checkout("merge"), action, artefacts)
    merge.steps(jobs["merge"]["steps"], {"Merge the shards": 1})
    check_merged(merge.text("summary"))
    shutil.rmtree(artefacts / "shard-2")
    lost = Job(project, project.checkout("lost"), action, artefacts)
    lost.steps(jobs["merge"]["steps"], {"Merge the shards": 2, "Write the summary": 2})
