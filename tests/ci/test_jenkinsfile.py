"""The Jenkinsfile: its `sh` steps, in the order in which its stages run."""

import re
from pathlib import Path

from ci_project import PACKAGING, check_merged, copy_artefact, make_project, run

STEP = re.compile(r"\bsh (?:'''(.*?)'''|'([^'\n]*)')", re.DOTALL)


def shell_steps(text: str) -> list[str]:
    """Return the `sh` steps as Groovy reads them: a backslash joins two lines."""
    steps = [(long or short).replace("\\\n", "") for long, short in STEP.findall(text)]
    assert all("\\" not in step for step in steps), "Groovy would replace a backslash"
    return steps


def test_shards_on_several_agents_are_merged(rtf: str, tmp_path: Path) -> None:
    project = make_project(rtf, tmp_path)
    steps = shell_steps((PACKAGING / "jenkins/Jenkinsfile").read_text())
    assert len(steps) == 4, f"install, shard, clean and merge, not {steps}"
    install, shard, clean, merge = steps

    def shell(step: str, directory: Path, expected: int = 0, **variables: str) -> None:
        script = directory.with_suffix(".sh")
        script.write_text(step)
        environment = project.environment(
            RTF_ARGS="-r tests", JENKINS_URL="http://jenkins/", **variables
        )
        run(["sh", "-xe", str(script)], directory, environment, expected)

    merged = project.checkout("merge")
    shell(install, merged)
    # What an earlier build left in the workspace must not be merged.
    (merged / "shards/1/old").mkdir(parents=True)
    (merged / "shards/1/old/events.jsonl").write_text("")
    shell(clean, merged)
    for number in ("1", "2"):
        directory = project.checkout(f"shard-{number}")
        # Installing is the same on all agents.
        (directory / ".rtf-venv").symlink_to(merged / ".rtf-venv")
        options = ["list", "-r", "tests", "--shard", f"{number}/2"]
        listed = run([project.rtf, *options], directory, project.environment())
        for _build in range(2):
            shell(shard, directory, int("Brake" in listed), SHARD=number, SHARDS="2")
        copy_artefact(directory / "shards", merged / "shards")
    shell(merge, merged, 1)
    check_merged((merged / "summary.md").read_text())
    assert (merged / "junit.xml").stat().st_size > 0, "the JUnit report"
