"""The templates of GitLab jobs."""

from pathlib import Path
from typing import Any

from ci_project import (
    PACKAGING,
    Project,
    check_merged,
    copy_artefact,
    load_yaml,
    make_project,
    run,
)


def resolve(templates: dict[str, Any], name: str) -> dict[str, Any]:
    """Return a template with those that it extends: variables are merged, the rest is replaced."""
    template = dict(templates[name])
    if "extends" not in template:
        return template
    base = resolve(templates, template.pop("extends"))
    variables = base.get("variables", {}) | template.get("variables", {})
    return base | template | {"variables": variables}


def run_job(
    project: Project, job: dict[str, Any], directory: Path, expected: int, **variables: str
) -> None:
    """Run the scripts of a job as GitLab's runner does, in one shell."""
    lines = [line for part in ("before_script", "script") for line in job[part]]
    script = directory.with_suffix(".sh")
    script.write_text("set -eo pipefail\n" + "\n".join(lines) + "\n")
    texts = {name: str(value) for name, value in (job["variables"] | variables).items()}
    environment = project.environment(GITLAB_CI="true", CI_PROJECT_DIR=str(directory), **texts)
    run(["bash", str(script)], directory, environment, expected)


def test_a_job_runs_all_tests_and_shards_are_merged(rtf: str, tmp_path: Path) -> None:
    project = make_project(rtf, tmp_path)
    templates = load_yaml(PACKAGING / "gitlab/rtf.yml")
    single = project.checkout("single")
    run_job(project, resolve(templates, ".rtf"), single, 1, RTF_ARGS="-r tests")
    check_merged((single / "summary.md").read_text())
    for report in ("junit.xml", "quality.json"):
        assert (single / report).stat().st_size > 0

    merge = project.checkout("merge")
    shard = resolve(templates, ".rtf-shard")
    # Installing is the same for all jobs.
    shard["before_script"] = [f"export PATH={single}/.rtf-venv/bin:$PATH"]
    count = int(shard["parallel"])
    for number in range(1, count + 1):
        directory = project.checkout(f"shard-{number}")
        options = ["list", "-r", "tests", "--shard", f"{number}/{count}"]
        listed = run([project.rtf, *options], directory, project.environment())
        indices = {"CI_NODE_INDEX": str(number), "CI_NODE_TOTAL": str(count)}
        run_job(project, shard, directory, int("Brake" in listed), RTF_ARGS="-r tests", **indices)
        copy_artefact(directory / "shards", merge / "shards")
    merging = resolve(templates, ".rtf-merge") | {"before_script": shard["before_script"]}
    run_job(project, merging, merge, 1)
    check_merged((merge / "summary.md").read_text())
    for report in ("junit.xml", "quality.json"):
        assert (merge / report).stat().st_size > 0
