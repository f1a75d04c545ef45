#!/usr/bin/env python3
"""Runs the conformance corpus with two installations of rtf, and compares all results.

    compare.py DIRECTORY NATIVE EMULATED

NATIVE and EMULATED are programs like `rtf`. DIRECTORY/NATIVE's name and DIRECTORY/EMULATED's
name contain the C++ plug-ins for each. The end-to-end tests prove that the native results are
those in `conformance/`; here, the emulated ones must be the same.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

CORPUS = Path(__file__).resolve().parents[2] / "conformance"
LANGUAGES = {"cpp": "dll", "lua": "lua", "python": "python"}
FIXTURES = ("fixture-value", "fixture-value-unknown")
"""Scenarios with a fixture that provides values."""
VALUES = ("port", "model", "ready", "limits")
CLOCK = "simulated-time"
"""A scenario with a clock, which only the end-to-end tests run."""


def main() -> int:
    """Return 1 if a result differs."""
    directory = Path(sys.argv[1])
    programs = [Path(program).resolve() for program in sys.argv[2:4]]
    excepted = {
        (entry["scenario"], entry["language"])
        for entry in json.loads((CORPUS / "exceptions.json").read_text())
    }
    different = 0
    for language in LANGUAGES:
        names = sorted(path.name for path in (CORPUS / "scenarios").iterdir())
        scenarios = [name for name in names if name != CLOCK and (name, language) not in excepted]
        native, emulated = (run(directory, rtf, language, scenarios) for rtf in programs)
        for scenario in scenarios:
            expected, found = native.get(scenario), emulated.get(scenario)
            if not expected or expected != found:
                different += 1
                print(f"{language} {scenario}:\n  native   {expected}\n  emulated {found}")
        print(f"{language}: {len(scenarios)} scenarios")
    print(f"{different} differ")
    return 1 if different else 0


def run(directory: Path, rtf: Path, language: str, scenarios: list[str]) -> dict[str, list[Any]]:
    """Run a suite for each scenario; return the facts of each scenario's test."""
    work = directory / f"{language}-{rtf.name}"
    work.mkdir()
    for scenario in scenarios:
        text = suite(directory / rtf.name, language, scenario)
        (work / f"{scenario}.xml").write_text(text)
    with (work / "output.txt").open("w") as output:
        subprocess.run([rtf, "run", "."], cwd=work, stdout=output, stderr=output, check=False)
    lines = (work / "rtf-results/latest/events.jsonl").read_text().splitlines()
    return facts([json.loads(line) for line in lines], work)


def plugin(plugins: Path, language: str, path: str) -> Path:
    """Find the plug-in of a scenario or a fixture."""
    if language == "cpp":
        return plugins / f"{Path(path).name}.so"
    return CORPUS / path / f"plugin.{'py' if language == 'python' else 'lua'}"


def suite(plugins: Path, language: str, scenario: str) -> str:
    """Return a suite with the scenario's test, and one after it."""
    kind = f'type="{LANGUAGES[language]}"'
    attributes = ""
    if scenario in ("hang", "interrupted-sleep"):
        attributes = 'timeout="1s" grace="5s"'
    elif scenario == "context":
        attributes = 'param="--joint elbow" repetition="3"'
    fixture = ""
    if scenario in FIXTURES:
        provided = "".join(f'<provide name="{value}"/>' for value in VALUES)
        file = plugin(plugins, language, "fixtures/simulator")
        fixture = f'<fixture {kind} name="simulator"> {file}{provided}</fixture>'
    test = plugin(plugins, language, f"scenarios/{scenario}")
    after = plugin(plugins, language, "scenarios/pass")
    return f"""<suite name="{scenario}">
  {fixture}<environment>--robot sim</environment>
  <test {kind} name="scenario" {attributes}>{test}</test>
  <test {kind} name="after">{after}</test>
</suite>
"""


def facts(events: list[dict[str, Any]], work: Path) -> dict[str, list[Any]]:
    """Return what each suite's tests reported, in order."""
    suites: dict[int, str] = {}
    tests: dict[int, str] = {}
    found: dict[str, list[Any]] = {}
    for event in events:
        kind = event["type"]
        if kind == "suite-planned":
            suites[event["suite"]] = event["name"]
            found[event["name"]] = []
        elif kind == "test-planned":
            tests[event["test"]] = suites[event["suite"]]
        source = event.get("source", event)
        if "test" in source:
            found[tests[source["test"]]].extend(facts_of(event, work))
    return found


def facts_of(event: dict[str, Any], work: Path) -> list[Any]:
    """Return what does not depend on time and paths."""
    kind = event["type"]
    if kind == "message":
        message = event["message"]
        parts = ("kind", "text", "critical", "comparison", "case")
        return [["message", *(message.get(part) for part in parts)]]
    if kind == "measured":
        return [[kind, {**event["measurement"], "location": None}]]
    if kind == "sampled":
        # How many samples are in an event depends on time.
        samples = event["samples"]
        limits = [samples.get(key) for key in ("name", "unit", "low", "high")]
        return [[kind, *limits, value] for _, value in samples["points"]]
    if kind == "attached":
        file = work / "rtf-results/latest" / event["attachment"]["path"]
        return [[kind, event["attachment"]["name"], file.read_text()]]
    fields = {
        "case-started": ["name", "parameters"],
        "case-finished": ["case", "verdict", "reason"],
        "test-finished": ["verdict", "reason", "phase", "exit"],
    }
    keys = fields.get(kind)
    return [[kind, *(event.get(key) for key in keys)]] if keys else []


if __name__ == "__main__":
    sys.exit(main())
