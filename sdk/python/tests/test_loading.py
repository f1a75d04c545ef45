"""Loading and checking of files."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from driver import PACKAGE, Host, arm, plugin, run


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("x = 1\n", "`FILE` has no class that derives from rtf.TestCase"),
        ("class Sim(rtf.FixtureManager): pass\n",
         "`FILE` has no class that derives from rtf.TestCase; it has `Sim`"),
        ("class A(rtf.TestCase): pass\nclass B(rtf.TestCase): pass\n",
         "`FILE` has several classes that derive from rtf.TestCase: `A`, `B`"),
        ("import nowhere\n", "ModuleNotFoundError: No module named 'nowhere'"),
        ("def broken(:\n", "SyntaxError: invalid syntax"),
        ("class Arm(rtf.TestCase): pass\n", "NotImplementedError: Arm has no `run`"),
    ],
)  # fmt: skip
def test_a_file_that_is_no_test_is_an_error(tmp_path: Path, body: str, reason: str) -> None:
    ran = run(tmp_path, body)
    expected = reason.replace("FILE", str(tmp_path / "plugin.py"))
    assert ran.result == {"outcome": "error"}
    assert ran.problem == ("error", expected)


def test_a_missing_file_is_an_error(tmp_path: Path) -> None:
    host = Host(tmp_path)
    host.ask("run-test", {"file": str(tmp_path / "gone.py"), "name": "Gone"})
    assert host.texts()[0][1].startswith("FileNotFoundError: ")


def test_a_syntax_error_is_reported_with_its_line(tmp_path: Path) -> None:
    ran = run(tmp_path, "x = 1\ndef broken(:\n")
    assert ran.host.of("message")[0]["location"]["line"] == 3


def test_bases_in_the_file_and_imported_classes_do_not_count(tmp_path: Path) -> None:
    (tmp_path / "bases.py").write_text("import rtf\nclass Other(rtf.TestCase): pass\n")
    body = (
        "from bases import Other\n"
        "class Base(Other):\n    def run(self): self.report(type(self).__name__)\n"
        "class Arm(Base): pass\n"
    )
    assert run(tmp_path, body).texts == [("report", "Arm")]


def test_a_plugin_may_have_any_name_and_leaves_nothing_behind(tmp_path: Path) -> None:
    host = Host(tmp_path)
    params = plugin(tmp_path, arm("pass"), name="arm test.v2")
    assert host.ask("run-test", params)["result"] == {"outcome": "passed"}
    assert [entry.name for entry in tmp_path.iterdir()] == ["arm test.v2"]


def test_the_directory_of_the_plugin_is_searched_but_the_working_directory_is_not(
    tmp_path: Path,
) -> None:
    # A host that searched the working directory would find the wrong `json`.
    (tmp_path / "json.py").write_text("raise RuntimeError('shadowed')\n")
    folder = tmp_path / "tests"
    folder.mkdir()
    (folder / "arms.py").write_text("JOINTS = 6\n")
    host = Host(tmp_path)
    body = "from arms import JOINTS\n" + arm("self.report(JOINTS)")
    assert host.ask("run-test", plugin(folder, body))["result"] == {"outcome": "passed"}
    assert host.texts() == [("report", "6")]


def test_the_second_plugin_of_a_host_is_not_the_first(tmp_path: Path) -> None:
    host = Host(tmp_path)
    for text in ("first", "second"):
        params = {**plugin(tmp_path, arm(f"self.report({text!r})")), "is_last": text == "second"}
        assert host.ask("run-test", params)["result"] == {"outcome": "passed"}
    assert host.texts() == [("report", "first"), ("report", "second")]
    assert host.end()[0] == 0


def test_a_shared_host_forgets_the_plugins_that_it_has_run(tmp_path: Path) -> None:
    host = Host(tmp_path)
    body = arm("import __main__\nself.report(vars(__main__).setdefault('number', number))")
    for number in range(3):
        named = plugin(tmp_path, f"number = {number}\n" + body)
        params = {**named, "is_last": False, "end_marker": "\0mark\n"}
        answer = host.ask("run-test", params)
        assert answer["result"] == {"outcome": "passed", "continues": True}
    assert host.texts() == [("report", str(number)) for number in range(3)]
    host.channel.close()


def test_a_shared_host_continues_after_a_failure_with_the_variables_of_each_test(
    tmp_path: Path,
) -> None:
    host = Host(tmp_path)
    body = arm("import os\nself.report(os.environ['RTF_EPISODE'])\nself.fail('stuck')")
    shared = {"is_last": False, "end_marker": "\0mark\n", "continues_after_failure": True}
    for episode in ("1", "2"):
        variables = [{"name": "RTF_EPISODE", "value": episode}]
        params = {**plugin(tmp_path, body), **shared, "variables": variables}
        answer = host.ask("run-test", params)
        assert answer["result"] == {"outcome": "failed", "continues": True}
    assert [text for kind, text in host.texts() if kind == "report"] == ["1", "2"]
    host.channel.close()


def test_output_comes_out_before_the_answer(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("import sys\nprint('a')\nsys.stdout.write('b')"))
    assert ran.output == "a\nb"


@pytest.mark.parametrize(
    ("method", "params", "code"),
    [
        ("paint-test", {}, -32601),
        ("run-test", {"name": "Arm"}, -32602),
        ("run-test", {"file": "a.py", "name": "Arm", "args": "x"}, -32602),
        ("initialize", {"protocol": 2, "rtf": "9.0.0"}, -32001),
    ],
)
def test_what_cannot_be_carried_out_is_refused(
    tmp_path: Path, method: str, params: dict[str, Any], code: int
) -> None:
    host = Host(tmp_path)
    assert host.ask(method, params)["error"]["code"] == code
    # The host continues.
    assert host.ask("tear-down-fixture", {})["result"] == {"outcome": "passed"}


def test_a_line_that_is_no_request_is_refused(tmp_path: Path) -> None:
    host = Host(tmp_path)
    host.channel.sendall(b"not a message\n[]\n")
    errors = [host.read(), host.read()]
    assert [error["error"]["code"] for error in errors if error] == [-32700, -32600]


def test_initialize_comes_first_and_names_the_interpreter(tmp_path: Path) -> None:
    version = ".".join(str(number) for number in sys.version_info[:3])
    assert Host(tmp_path).initialized["result"] == {
        "protocol": 1,
        "host": f"python {version}",
        "stack": "none",
        "supports_shared": True,
        "selects_cases": True,
        "runs_episodes": True,
    }


def _command(*arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE)}
    command = [sys.executable, "-m", "rtf.host", *arguments]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def test_files_are_checked_without_running_them(tmp_path: Path) -> None:
    files = {
        "test.py": "import rtf\nprint('ran')\nclass A(rtf.TestCase): pass\nclass B(A): pass\n",
        "fixture.py": "from rtf import FixtureManager\nclass A(FixtureManager): pass\n",
        "unknown.py": "from bases import Base\nclass A(Base): pass\n",
        "helper.py": "class Client: pass\ndef connect(): return Client()\n",
        "broken.py": "x = 1\nclass A(:\n",
        "outside.py": "return 3\n",
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    checked = _command("--check", *files, "gone.py", folder=tmp_path)
    assert checked.returncode == 0
    assert [json.loads(line) for line in checked.stdout.splitlines()] == [
        {"file": "test.py", "ok": True, "kinds": ["test"]},
        {"file": "fixture.py", "ok": True, "kinds": ["fixture"]},
        {"file": "unknown.py", "ok": True},
        {"file": "helper.py", "ok": True, "kinds": []},
        {"file": "broken.py", "ok": False, "message": "invalid syntax", "line": 2},
        {"file": "outside.py", "ok": False, "message": "'return' outside function", "line": 1},
        {"file": "gone.py", "ok": False, "message": "No such file or directory"},
    ]


def test_a_host_that_no_runner_started_says_so(tmp_path: Path) -> None:
    started = _command(folder=tmp_path)
    assert started.returncode == 2
    assert "`rtf` starts" in started.stderr
