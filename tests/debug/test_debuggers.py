"""Debugs a test of each language on a pseudo-terminal, with the debugger that its users have.

The commands are those of docs/how-to/debugging.md.
"""

import os
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest
from checkout import ROOT, call
from terminal import Terminal

HERE = Path(__file__).resolve().parent
# The limit of each test; a session takes longer.
LIMIT = 1.0
DONE = "fixture arm is stopped\n"
SUITE = f"""\
<suite name="arm" timeout="{LIMIT:g}s">
  <fixture name="arm" type="process">
    <command>sh {HERE}/fixture.sh</command>
    <ready log="ready"/>
    <stop grace="20s"/>
  </fixture>
  <test name="Python" type="python" timeout="{LIMIT:g}s">{HERE}/reach.py</test>
  <test name="Busy" type="python" timeout="{LIMIT:g}s">{HERE}/busy.py</test>
  <test name="Lua" type="lua" timeout="{LIMIT:g}s">{HERE}/reach.lua</test>
  <test name="Ruby" type="ruby" timeout="{LIMIT:g}s">{HERE}/reach.rb</test>
  <test name="Cpp" type="dll" timeout="{LIMIT:g}s" isolation="shared" retries="2">reach</test>
</suite>
"""
PROGRAM = '<suite name="p"><test type="program">/bin/true</test></suite>'


class Bench:
    """A directory with the suite."""

    def __init__(self, rtf: str, plugins: Path, directory: Path) -> None:
        """Write the suite."""
        self.rtf, self.directory = rtf, directory
        (directory / "arm.xml").write_text(SUITE)
        self.environment = os.environ | {
            "RTF_PLUGIN_PATH": str(plugins),
            "TERM": "dumb",
            # Otherwise, `CI=true` asks for colours.
            "NO_COLOR": "1",
            "HOME": str(directory),
        }

    def debug(self, *arguments: str) -> Terminal:
        """Start a run on a terminal."""
        return Terminal([self.rtf, "run", *arguments], self.directory, self.environment)

    def stopped_fixtures(self) -> int:
        """Return how often the fixture was torn down."""
        log = self.directory / "fixture.log"
        return log.read_text().count(DONE) if log.exists() else 0

    def finish(self, session: Terminal, code: int, last: str) -> None:
        """Check the end of a run: exit code, last line, tear-down, terminal."""
        assert session.finish() == code, f"exit code {code}\n{session.output}"
        assert re.search(f"^{last}", session.output, re.M) is not None, f"{last}\n{session.output}"
        assert self.stopped_fixtures() == 1, f"the fixture was torn down\n{session.output}"


@pytest.fixture(scope="session")
def plugins(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The directory of the plug-in in C++."""
    directory = tmp_path_factory.mktemp("plugins")
    headers = [f"-I{ROOT}/sdk/cpp/include", f"-I{ROOT}/sdk/c/include"]
    compiler = ["c++", "-std=c++17", "-g", "-O0", "-shared", "-fPIC", *headers]
    call(*compiler, HERE / "reach.cpp", "-o", directory / "libreach.so")
    return directory


@pytest.fixture
def bench(rtf: str, plugins: Path, tmp_path: Path) -> Bench:
    """A directory with the suite."""
    return Bench(rtf, plugins, tmp_path)


def wait_longer_than_the_limits(session: Terminal, bench: Bench) -> int:
    """Wait at a prompt; return the process group in the foreground."""
    time.sleep(2 * LIMIT)
    assert bench.stopped_fixtures() == 0 or session.foreground() != session.pid, "the fixture is up"
    assert session.foreground() != session.pid, "the terminal is the test's"
    return session.foreground()


def test_pdb_shows_a_variable_and_continues(bench: Bench) -> None:
    """`breakpoint()` in a Python test."""
    with bench.debug("--debug", "arm.xml::Python") as session:
        pid = int(session.expect(r"^debug: process (\d+) has the terminal; .* kill -INT (\d+)$")[1])
        session.expect(r"\(Pdb\) ")
        assert wait_longer_than_the_limits(session, bench) == pid, "its process group leads"
        session.send("p angle\n")
        session.expect(r"^42\n\(Pdb\) ")
        session.interrupt()
        session.expect("KeyboardInterrupt")
        session.expect(r"\(Pdb\) ")
        session.send("c\n")
        session.expect("^the angle is 42$")
        bench.finish(session, 0, "PASSED  1 test ")


def test_ctrl_c_stops_a_test_in_pdb_and_not_the_run(bench: Bench) -> None:
    """Ctrl-C stops a test in pdb, not the run; after the test, it ends the run."""
    with bench.debug("--debug", "arm.xml::Busy") as session:
        session.expect(r"\(Pdb\) ")
        session.send("c\n")
        session.expect("^turning$")
        session.interrupt()
        session.expect(r"\(Pdb\) ")
        session.send("p turns >= 0\n")
        session.expect("^True\n")
        session.send("q\n")
        bench.finish(session, 1, "FAILED  1 test ")


def test_sigint_ends_the_run_while_the_test_has_the_terminal(bench: Bench) -> None:
    """SIGINT to rtf ends the run while the test has the terminal."""
    with bench.debug("--debug", "arm.xml::Python") as session:
        rtf = int(session.expect(r"^debug: process .* kill -INT (\d+)$")[1])
        assert rtf == session.pid, "the process that the user started"
        session.expect(r"\(Pdb\) ")
        hold = bench.directory / "hold"
        hold.touch()
        os.kill(rtf, signal.SIGINT)
        session.expect("^ *interrupted +[0-9.]+ s")
        assert session.foreground() == session.pid, "rtf has the foreground again"
        assert session.has_first_settings(), "the terminal has its first settings"
        hold.unlink()
        bench.finish(session, 130, "INTERRUPTED")


def test_a_shell_gets_its_terminal_back(bench: Bench) -> None:
    """In a shell: Ctrl-Z does nothing, SIGQUIT kills the test, and the shell gets its terminal."""
    command = f"{bench.rtf} run --debug arm.xml::Python; echo exit code $?\n"
    environment = bench.environment | {"PS1": "shell> "}
    with Terminal(["bash", "--norc", "-i"], bench.directory, environment) as session:
        session.expect("^shell> ")
        session.send(command)
        session.expect(r"\(Pdb\) ")
        session.send("\x1a")
        session.send("p angle + 1\n")
        session.expect(r"^43\n\(Pdb\) ")
        session.send("c\n")
        session.expect("^exit code 0\nshell> ")
        session.send(command)
        session.expect(r"\(Pdb\) ")
        session.send("\x1c")
        session.expect(r"ended in run with signal 3 \(SIGQUIT\)")
        session.expect("^exit code 1\nshell> ")
        session.send("exit 3\n")
        assert session.finish() == 3, session.output


def test_lua_debugs_in_its_console(bench: Bench) -> None:
    """`debug.debug()` in a Lua test."""
    with bench.debug("--debug", "arm.xml::Lua") as session:
        session.expect("lua_debug> ")
        wait_longer_than_the_limits(session, bench)
        session.send("print('angle', angle)\n")
        session.expect(r"^angle\s+42$")
        session.send("cont\n")
        bench.finish(session, 0, "PASSED  1 test ")


def test_irb_shows_a_variable_and_continues(bench: Bench) -> None:
    """`binding.irb` in a Ruby test."""
    with bench.debug("--debug", "arm.xml::Ruby") as session:
        session.expect(r"irb\(.*> ")
        wait_longer_than_the_limits(session, bench)
        session.send("angle + 1\n")
        session.expect("=> 43")
        session.send("exit\n")
        bench.finish(session, 0, "PASSED  1 test ")


def test_gdb_starts_a_test_in_cpp(bench: Bench) -> None:
    """A C++ test that gdb starts."""
    with bench.debug("--debugger", "gdb -q --args", "arm.xml::Cpp") as session:
        session.expect(r"\(gdb\) ")
        session.send("set breakpoint pending on\n")
        session.expect(r"\(gdb\) ")
        session.send("break Reach::run\n")
        session.expect(r"\(gdb\) ")
        session.send("run\n")
        session.expect(r"Breakpoint 1, Reach::run")
        session.expect(r"\(gdb\) ")
        wait_longer_than_the_limits(session, bench)
        session.send("next\n")
        session.expect(r"\(gdb\) ")
        session.send("print angle\n")
        session.expect(r"\$1 = 42")
        session.send("continue\n")
        session.expect(r"exited normally")
        session.send("quit\n")
        bench.finish(session, 0, "PASSED  1 test ")


def test_gdb_attaches_to_a_waiting_test(bench: Bench) -> None:
    """Attach gdb to the waiting process of a C++ test."""
    command = [bench.rtf, "run", "--debug-wait", "arm.xml::Cpp"]
    with subprocess.Popen(
        command,
        cwd=bench.directory,
        env=bench.environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as run:
        assert run.stderr
        line = run.stderr.readline()
        pid = re.match(r"debug: process (\d+) waits for a debugger; .* kill -USR1 (\d+)$", line)
        assert pid, line
        time.sleep(2 * LIMIT)
        commands = [
            "set breakpoint pending on",
            "break Reach::run",
            "continue",
            "next",
            "print angle",
            "detach",
        ]
        options = [word for text in commands for word in ("-ex", text)]
        attached = subprocess.run(
            ["gdb", "-q", "-batch", "-p", pid[1], *options],
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert "$1 = 42" in attached.stdout, attached.stdout + attached.stderr
        output, errors = run.communicate(timeout=120)
        assert run.returncode == 0, output + errors


def test_a_signal_continues_a_waiting_test(bench: Bench) -> None:
    """Without a debugger, SIGUSR1 starts the test; a stop of the run ends the wait."""
    for number, code in ((signal.SIGUSR1, 0), (signal.SIGINT, 130)):
        command = [bench.rtf, "run", "--debug-wait", "arm.xml::Lua"]
        with subprocess.Popen(
            command,
            cwd=bench.directory,
            env=bench.environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as run:
            assert run.stderr
            runner = int(run.stderr.readline().split()[-1])
            os.kill(runner if number == signal.SIGUSR1 else run.pid, number)
            output, errors = run.communicate(timeout=120)
            assert run.returncode == code, output + errors


def test_what_cannot_be_debugged_is_refused(bench: Bench) -> None:
    """Several tests, no terminal, a format for programs."""

    def error(*arguments: str) -> str:
        result = subprocess.run(
            [bench.rtf, "run", *arguments],
            cwd=bench.directory,
            env=bench.environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert result.returncode == 2, result.stderr
        return result.stderr

    (bench.directory / "program.xml").write_text(PROGRAM)
    program = error("--debug-wait", "program.xml")
    assert "a test of type `program` runs in processes of its framework" in program, program
    several = error("--debug-wait", "arm.xml")
    assert "one test can be debugged, but 5 tests are selected" in several, several
    assert "name one of `arm.xml::Python`, `arm.xml::Busy`, `arm.xml::Lua`" in several, several
    assert "standard input is no terminal" in error("--debug", "arm.xml::Lua"), "no terminal"
    assert "mixed with that of `--format`" in error(
        "--debug", "--format", "json", "arm.xml::Lua"
    ), "the format"
