"""The command lines for both runners, and their outcomes.

`old` is the outcome with 2.x, `new` that with ours if it differs, and `why` the reason. A number
is that of the defect in docs/how-to/migrating-rtf2.md.
"""

from __future__ import annotations

from dataclasses import dataclass

GOOD = """TestCase.setup = function(param)
  robottestingframework.testReport(param .. "/" .. robottestingframework.getEnvironment())
  return true
end
TestCase.run = function() robottestingframework.testCheck(true, "closed") end
TestCase.tearDown = function() robottestingframework.testReport("torn down") end
"""

SETUP = "TestCase.setup = function(param) return true end\n"
TEAR_DOWN = "TestCase.tearDown = function() end\n"


def lua(run: str) -> str:
    """A test with this body."""
    return f"{SETUP}TestCase.run = function()\n{run}\nend\n{TEAR_DOWN}"


def suite(name: str, tests: str) -> str:
    """A suite with these elements."""
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<suite name="{name}">\n{tests}\n</suite>\n'


def test(name: str, attributes: str = 'type="lua"') -> str:
    """A test."""
    return f"<test {attributes}> {name} </test>"


CHECKS = """  robottestingframework.testCheck(true, "closed")
  robottestingframework.testCheck(false, "open")
  robottestingframework.testFailIf(false, "unless")
  robottestingframework.testReport("on")"""

# Waits for a file, so that a signal arrives while it runs.
WAITS = """  io.open("started", "w"):close()
  repeat local go = io.open("go") until go"""

FILES = {
    "Good.lua": GOOD,
    "Bad.lua": lua(CHECKS),
    "Fails.lua": lua('robottestingframework.assertFail("too fast")'),
    "Errs.lua": lua('robottestingframework.assertError("no bus")'),
    "NoSetup.lua": f"TestCase.setup = function(param) return false end\n{lua('')[len(SETUP) :]}",
    "Named.lua": lua('robottestingframework.testReport("on")').replace(
        "return true", 'robottestingframework.setName("Other") return true'
    ),
    "Exits.lua": lua("os.exit(0)"),
    "Percent.lua": lua('robottestingframework.assertError("100% %s %n")'),
    "Long.lua": lua('robottestingframework.testReport(("x"):rep(5000))'),
    "Waits.lua": lua(WAITS),
    "plain/One.lua": GOOD,
    "plain/Two.lua": lua(CHECKS),
    "plain/more/Three.lua": GOOD,
    "plain/note.txt": "",
    "suites/arm.xml": suite(
        "arm",
        "<description>an arm</description>\n<environment>--robot sim</environment>\n"
        + test("Good.lua", 'type="lua" param="--n 3"')
        + test("plain/Two.lua"),
    ),
    "suites/more/leg.xml": suite("leg", test("Good.lua")),
    "suites/robot.xml": "<robot/>",
    "green.xml": suite("green", test("Good.lua") + test("Good.lua")),
    "named.xml": suite("named", test("Named.lua") + test("Named.lua")),
    "red.xml": suite("red", "".join(map(test, ("Errs.lua", "Fails.lua", "Good.lua")))),
    "missing.xml": suite("missing", test("Good.lua") + test("Gone.lua")),
    "none.xml": suite("none", ""),
    "often.xml": suite("often", test("Fails.lua", 'type="lua" repetition="3"') + test("Good.lua")),
    "exits.xml": suite("exits", test("Fails.lua") + test("Exits.lua")),
    "comments.xml": suite(
        "comments",
        "<!-- <test>Gone.lua --x --y</test> -->\n<!----- ruler ----->" + test("Good.lua"),
    ),
    "types.xml": suite(
        "types",
        test("Good.lua", "") + test("./Good.lua", 'type="LUA"') + "<test>plain/One.lua</test>",
    ),
    "params.xml": suite(
        "params",
        test("Good.lua", 'type="lua" param="--a &quot;b c&quot; \'d e\' C:\\f &lt;"')
        + test("Good.lua", "type='lua' param='--a \"b c\" d\"e f\"g'")
        + test("Good.lua", "type='lua' param='one&#10;two'"),
    ),
    # The same test three times, because the file system determines their order in 2.x.
    "interrupt/1.xml": suite("waits", test("Waits.lua")),
    "interrupt/2.xml": suite("waits", test("Waits.lua")),
}


@dataclass(frozen=True)
class Case:
    """One command line."""

    options: list[str]
    old: str
    new: str = ""
    why: str = ""
    result: str = "result.txt"
    in_any_order: bool = False
    interrupt: bool = False

    def options_name(self, name: str) -> str:
        """The value of an option."""
        return self.options[self.options.index(name) + 1] if name in self.options else ""


SAID = "[INFO] closed; [INFO] torn down"
GOOD_PASSED = f"passed: [INFO] /; {SAID}"
BAD = "failed: [INFO] closed; [FAIL] open; [FAIL] unless; [INFO] on"
GREEN = "0 | cases 1 = 1 + 0"
RED = "1 | cases 1 = 0 + 1"
RED_SUITE = "1 | suites 1 = 0 + 1, cases 3 = 1 + 2"
RED_TESTS = f"Errs failed: [ERROR] no bus, Fails failed: [FAIL] too fast, Good {GOOD_PASSED}"
RED_JUNIT = (
    "red.Errs.lua error: [ERROR] (Errs.lua) no bus, "
    "red.Fails.lua failure: [FAIL] (Fails.lua) too fast, "
    "red.Good.lua passed: "
    "[INFO] (Good.lua) /; [INFO] (Good.lua) closed; [INFO] (Good.lua) torn down"
)
OTHER = "Other passed: [INFO] (Other) on"
ARM = f"Good passed: [INFO] --n 3/--robot sim; {SAID}, Two {BAD}, arm failed"
PARAMS = ["--a \"b c\" 'd e' C:\\f <", '--a "b c" d"e f"g']
REFUSED_BY_US = "1 | no counts | no file"
EXITED = "failed: [ERROR] the test's process ended in run with exit code 0 before the test was over"
STOPPED = "[ERROR] stopped by SIGINT"

CASES = [
    Case(["--test", "Good.lua"], f"{GREEN} | Good {GOOD_PASSED}"),
    Case(["-t", "./Good.lua", "more"], f"{GREEN} | Good {GOOD_PASSED}"),
    Case(["--test=Good.lua", "--repetition", "0"], f"{GREEN} | Good {GOOD_PASSED}"),
    Case(
        ["-t", "Good.lua", "-p", '--x "y z"', "-e", "--robot icub"],
        f'{GREEN} | Good passed: [INFO] --x "y z"/--robot icub; {SAID}',
    ),
    Case(
        ["-t", "Bad.lua", "-t", "Good.lua", "-p", "a", "-p", "-v"],
        f"{GREEN} | Good passed: [INFO] -v/; {SAID}",
    ),
    Case(["-t", "Bad.lua"], f"{RED} | Bad {BAD}"),
    Case(["-dv", "-t", "Bad.lua"], f"{RED} | Bad {BAD}"),
    Case(["-t", "Fails.lua"], f"{RED} | Fails failed: [FAIL] too fast"),
    Case(["-t", "Errs.lua"], f"{RED} | Errs failed: [ERROR] no bus"),
    Case(["-t", "Percent.lua"], f"{RED} | Percent failed: [ERROR] 100% %s %n"),
    Case(["-t", "Long.lua"], f"{GREEN} | Long passed: 5000 letters"),
    Case(
        ["--tests", "plain", "--param", "x", "--environment", "y"],
        f"1 | cases 2 = 1 + 1 | One {GOOD_PASSED}, Two {BAD}",
        in_any_order=True,
    ),
    Case(
        ["--tests", "plain/", "-r"],
        f"1 | cases 3 = 2 + 1 | One {GOOD_PASSED}, Three {GOOD_PASSED}, Two {BAD}",
        in_any_order=True,
    ),
    Case(
        ["-s", "green.xml"],
        "0 | suites 1 = 1 + 0, cases 2 = 2 + 0 | "
        f"Good {GOOD_PASSED}, Good {GOOD_PASSED}, green passed",
    ),
    Case(["--suite", "red.xml"], f"{RED_SUITE} | {RED_TESTS}, red failed"),
    Case(
        ["--suite", "suites/arm.xml", "-t", "Good.lua", "-p", "x"],
        f"1 | suites 1 = 0 + 1, cases 3 = 2 + 1 | Good passed: [INFO] x/; {SAID}, {ARM}",
    ),
    Case(["--suites", "suites"], f"1 | suites 1 = 0 + 1, cases 2 = 1 + 1 | {ARM}"),
    Case(
        ["--suites", "suites", "--recursive"],
        "1 | suites 2 = 1 + 1, cases 3 = 2 + 1 | "
        f"Good passed: [INFO] --n 3/--robot sim; {SAID}, Good {GOOD_PASSED}, "
        f"Two {BAD}, arm failed, leg passed",
        in_any_order=True,
    ),
    Case(["-s", "red.xml", "--no-summary"], f"1 | no counts | {RED_TESTS}, red failed"),
    Case(["-s", "red.xml", "--no-output"], f"{RED_SUITE} | no file"),
    Case(["-s", "red.xml", "-o", "x"], f"{RED_SUITE} | {RED_TESTS}, red failed", result="x"),
    Case(
        ["-s", "red.xml", "--output-type", "junit"],
        f"{RED_SUITE} | {RED_JUNIT}",
        result="result.xml",
    ),
    Case(
        ["-s", "red.xml", "--output-type", "junit", "--output", "x"],
        f"{RED_SUITE} | {RED_JUNIT}",
        result="x",
    ),
    Case(
        ["-t", "Named.lua", "--output-type", "junit"],
        f"{GREEN} | default.{OTHER}",
        result="result.xml",
    ),
    Case(
        ["-s", "named.xml", "--output-type", "junit"],
        f"0 | suites 1 = 1 + 0, cases 2 = 2 + 0 | named.{OTHER}, named.{OTHER}",
        result="result.xml",
    ),
    Case(
        ["-s", "comments.xml"],
        f"0 | suites 1 = 1 + 0, cases 1 = 1 + 0 | Good {GOOD_PASSED}, comments passed",
    ),
    Case(
        ["-s", "types.xml"],
        "0 | suites 1 = 1 + 0, cases 3 = 3 + 0 | "
        f"Good {GOOD_PASSED}, Good {GOOD_PASSED}, One {GOOD_PASSED}, types passed",
    ),
    Case(
        ["-s", "params.xml"],
        "0 | suites 1 = 1 + 0, cases 3 = 3 + 0 | "
        + "".join(f"Good passed: [INFO] {param}/; {SAID}, " for param in PARAMS)
        + f"Good passed: [INFO] one; {SAID}, params passed",
    ),
    Case(
        ["-s", "missing.xml"],
        f"0 | suites 1 = 1 + 0, cases 1 = 1 + 0 | Good {GOOD_PASSED}, missing passed",
        REFUSED_BY_US,
        "1: a plug-in that was not found was skipped",
    ),
    Case(
        ["-s", "none.xml"],
        "0 | suites 1 = 1 + 0, cases 0 = 0 + 0 | none passed",
        REFUSED_BY_US,
        "1: a suite without tests was green",
    ),
    Case(["--tests", "empty"], "0 | cases 0 = 0 + 0 | ", REFUSED_BY_US, "1: no test was green"),
    Case(["--suites", "empty"], "0 | cases 0 = 0 + 0 | ", REFUSED_BY_US, "1: no test was green"),
    Case(
        ["-t", "Good.lua", "--repetition", "3"],
        f"{GREEN} | Good passed: [INFO] /; {'[INFO] closed; ' * 4}[INFO] torn down",
        f"{GREEN} | Good passed: " + "; ".join([f"[INFO] /; {SAID}"] * 3),
        "2: three repetitions ran four times; ours are whole tests",
    ),
    Case(
        ["-s", "often.xml"],
        f"0 | suites 1 = 1 + 0, cases 1 = 1 + 0 | Good {GOOD_PASSED}, often passed",
        "1 | suites 1 = 0 + 1, cases 2 = 1 + 1 | "
        f"Fails failed: {'; '.join(['[FAIL] too fast'] * 3)}, Good {GOOD_PASSED}, often failed",
        "2: a repetition dropped the test",
    ),
    Case(
        ["-t", "Exits.lua"],
        REFUSED_BY_US.replace("1", "0"),
        f"{RED} | Exits {EXITED}",
        "3: exit(0)",
    ),
    Case(
        ["-s", "exits.xml"],
        REFUSED_BY_US.replace("1", "0"),
        "1 | suites 1 = 0 + 1, cases 2 = 0 + 2 | "
        f"Fails failed: [FAIL] too fast, Exits {EXITED}, exits failed",
        "3: exit(0) hid the failure before it",
    ),
    Case(
        ["--suites", "interrupt"],
        "0 | suites 1 = 1 + 0, cases 1 = 1 + 0 | "
        "Waits passed: [INFO] TestCase interrupted: An interrupt signal received, waits passed",
        "1 | suites 2 = 0 + 2, cases 2 = 0 + 2 | "
        f"Waits failed: {STOPPED}, Waits failed: {STOPPED}, "
        "[ERROR] the run was interrupted: SIGINT, waits failed, waits failed",
        "6: Ctrl-C in the first of two suites was green",
        in_any_order=True,
        interrupt=True,
    ),
    Case(
        ["-t", "Good.lua", "-o", "/proc/nowhere/x"],
        f"{GREEN} | no file",
        REFUSED_BY_US,
        "7: a file that cannot be written was no error",
    ),
    Case(
        ["-t", "Good.lua", "--output-type", "xml"],
        f"{GREEN} | no file",
        REFUSED_BY_US,
        "7: an unknown type was no error",
    ),
    Case(
        ["-t", "Named.lua"],
        f"{GREEN} | Other passed: [INFO] on",
        f"{GREEN} | Named passed: [INFO] test name: Other; [INFO] on",
        "a test has the name from its suite or its file",
    ),
    Case(
        ["-t", "NoSetup.lua"],
        f"{RED} | NoSetup failed: [ERROR] ",
        f"{RED} | NoSetup failed: [ERROR] setup returned false",
        "the reason is reported",
    ),
]
REFUSED: list[tuple[list[str], str]] = [
    (["--test", "Gone.lua"], "1"),
    (["--test", "Gone.so"], "1"),
    (["--suite", "Gone.xml"], "1"),
    (["--suite", "Good.lua"], "1"),
    (["--suite", "suites/robot.xml"], "1"),
    (["--tests", "gone"], "1"),
    (["--suites", "gone"], "1"),
    ([], "1"),
    (["Good.lua"], "1"),
    (["--tset", "Good.lua"], "1"),
    (["--test"], "1"),
    (["--test", "Good.lua", "--repetition", "many"], "1"),
    (["--help"], "0"),
    (["-?"], "0"),
    (["--version"], "0"),
]
