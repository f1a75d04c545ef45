"""The sources: formats, linters, types, generated files, dependencies, and the words in them."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from checkout import ROOT, TARGET, call, venv

PYTHON = """
    examples fixtures packaging tools tests benches web/tests crates/rtf/templates
""".split()
UNTYPED = (
    "tests/colcon/workspace",
    "tests/fixtures/yarp/plugins/",
    "tests/frameworks/",
    "tests/import/workspace",
    "tests/install/",
)
"""Tests and programs as users write them, except the checks of frameworks."""

SUITES = """
    :(glob)examples/*/*.xml crates/rtf/templates/*.xml tests/install/*.xml tests/wheel/*.xml
    tests/fixtures/*/suite.xml tests/frameworks/*/suite.xml tests/ctest/project/arm.xml
    tests/colcon/workspace/src/*/test/*.xml tests/fixtures/yarp/suites/*.xml
    tests/fixtures/ros1/*.xml tests/fixtures/clock/*.xml tests/fixtures/replay/*.xml
    tests/fixtures/signals/*.xml tests/fixtures/proxies/*.xml tests/fixtures/ros2bag/*.xml
""".split()
"""XML files in subdirectories of examples belong to the middleware."""

PROSE = """
    *.md Makefile .ci/run tools/* benches/* :(glob)tests/*.py tests/harness/* tests/install/*
    tests/predecessor/* tests/wheel/* packaging/* crates/*/src/*.rs
""".split()


def files(*patterns: str, without: tuple[str, ...] = ()) -> list[str]:
    """The project's files that match, including those that are not committed yet."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "--", *patterns]
    listed = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    names = [name for name in listed.stdout.splitlines() if not name.startswith(without)]
    present = [name for name in names if (ROOT / name).exists()]
    assert present, f"no file matches {patterns}"
    return present


def typed() -> list[str]:
    """The directories whose types are checked, apart: their modules may have the same names."""
    # The campaign's scripts and the wheel's builder import what is only in their environments.
    untyped = ("examples/10-campaign", "examples/12-policies", "packaging/wheel")
    modules = files("examples/*.py", "fixtures/*.py", "packaging/*.py", without=untyped)
    modules += files("crates/rtf/templates/new/python/*.py", "tools/*.py", "benches/bench.py")
    modules += files("tests/*.py", without=UNTYPED)
    directories = {str(Path(module).parent) for module in modules}
    return sorted(directories | {"tests/frameworks", "tests/frameworks/public"})


def test_shell() -> None:
    call("shellcheck", *files("*.sh", ".ci/run"))


def test_rust_format() -> None:
    call("cargo", "fmt", "--all", "--check", "--", "--color", "never")


def test_cpp_format() -> None:
    # cbindgen generates the header.
    sources = files("*.c", "*.h", "*.cpp", "*.hpp", without=("sdk/c/include/rtf/plugin.h",))
    call("clang-format", "--style=file:sdk/.clang-format", "--dry-run", "--Werror", *sources)


@pytest.mark.parametrize("command", ["check", "format --check"])
def test_python(command: str) -> None:
    call(venv("test") / "ruff", *command.split(), *PYTHON)


@pytest.mark.parametrize("directory", typed())
def test_python_types(directory: str) -> None:
    path = f"tests/debug:tests/executors:{directory}"
    call(venv("test") / "mypy", *sorted((ROOT / directory).glob("*.py")), MYPYPATH=path)


def test_ruby() -> None:
    call("rubocop", ".", cwd=ROOT / "sdk/ruby")


def test_ruby_plugins() -> None:
    # Plug-ins are named after their class and described by one comment.
    cops = """Naming/FileName,Style/Documentation,Style/FrozenStringLiteralComment,
        Lint/BinaryOperatorWithIdenticalOperands"""
    options = ["--config", "sdk/ruby/.rubocop.yml", "--except", "".join(cops.split())]
    call("rubocop", *options, *files("*.rb", without=("sdk/ruby/",)))


def test_suites() -> None:
    found = files(*SUITES)
    campaigns = [file for file in found if "\n<campaign" in "\n" + (ROOT / file).read_text()]
    suites = [file for file in found if file not in campaigns]
    call("xmllint", "--noout", "--schema", "spec/suite.xsd", *suites)
    call("xmllint", "--noout", "--schema", "spec/campaign.xsd", *campaigns)


def test_language() -> None:
    found = files(*PROSE, without=("tools/check_language.py",))
    call("tools/check_language.py", *(name for name in found if not name.endswith(".json")))


@pytest.mark.parametrize("tool", ["version.py", "check_security.py", "supply_chain.sh"])
def test_promises(tool: str) -> None:
    """One version in all files, the promises of SECURITY.md, and accepted dependencies only."""
    call(f"tools/{tool}")


@pytest.mark.first
def test_rust() -> None:
    command = "cargo clippy --quiet --workspace --all-targets --locked -- -D warnings"
    call(*command.split())


@pytest.mark.first
def test_rust_docs() -> None:
    command = "cargo doc --quiet --workspace --no-deps --document-private-items --locked"
    call(*command.split(), RUSTDOCFLAGS="-D warnings")


@pytest.mark.usefixtures("debug_rtf")
@pytest.mark.parametrize("generated", ["schemas", "header"])
def test_generated(generated: str) -> None:
    """The committed files are those that their sources make."""
    call(TARGET / "debug/xtask", generated, "--check")
