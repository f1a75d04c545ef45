//! Forked hosts behave like executed ones.

use std::collections::BTreeSet;

use rtf_model::{Record, TestId, Verdict};

use crate::support::{Folder, build_cpp, nothing_left, root};

/// Says whether it was forked, and what a process that is looked for by its
/// environment must show there.
const LUA: &str = r#"
local function read(path)
  local file = io.open(path, "rb")
  local text = file and file:read("a") or ""
  if file then file:close() end
  return text
end

--- The server among the runner's children.
local function server()
  local runner = read("/proc/self/status"):match("PPid:%s*(%d+)")
  for task in io.popen("ls /proc/" .. runner .. "/task"):lines() do
    for pid in read("/proc/" .. runner .. "/task/" .. task .. "/children"):gmatch("%d+") do
      if read("/proc/" .. pid .. "/environ"):find("RTF_FORK_SERVER=", 1, true) then return pid end
    end
  end
end

TestCase = {}

function TestCase.run()
  local own = read("/proc/self/environ")
  rtf.check(not own:find("RTF_FORK_SERVER=", 1, true), "no trace of the server")
  rtf.check(own:find("RTF_SCOPE=" .. os.getenv("RTF_SCOPE"), 1, true), "the scope is shown")
  rtf.check(own:find("RTF_OWNER=" .. os.getenv("RTF_OWNER"), 1, true), "the owner is shown")
  rtf.check(os.getenv("RTF_CHANNEL") == nil, "the channel is hidden")
  rtf.check(os.getenv("RTF_FORK_SERVER") == nil, "the variable is hidden")
  local pid = server()
  rtf.report(pid and "a server is there" or "no server is there")
  if pid and os.getenv("KILL_SERVER") then os.execute("kill -KILL " .. pid) end
end
"#;

/// The same in Python.
const PYTHON: &str = r#"
import os
import random
import sys
import threading
import rtf


def environ(pid):
    try:
        with open(f"/proc/{pid}/environ", "rb") as stream:
            return stream.read().split(b"\0")
    except OSError:
        return []


def server():
    runner = os.getppid()
    for task in os.listdir(f"/proc/{runner}/task"):
        with open(f"/proc/{runner}/task/{task}/children") as stream:
            for pid in stream.read().split():
                if any(entry.startswith(b"RTF_FORK_SERVER=") for entry in environ(pid)):
                    return int(pid)
    return None


class Forked(rtf.TestCase):
    def run(self):
        own = environ("self")
        self.check(not any(e.startswith(b"RTF_FORK_SERVER=") for e in own), "no trace of the server")
        for name in ("RTF_SCOPE", "RTF_OWNER"):
            self.check(f"{name}={os.environ[name]}".encode() in own, f"{name} is shown")
        self.check("RTF_CHANNEL" not in os.environ, "the channel is hidden")
        self.check("RTF_FORK_SERVER" not in os.environ, "the variable is hidden")
        self.check(os.getpgid(0) == os.getpid(), "it leads its group")
        self.check(threading.get_native_id() == os.getpid(), "its thread has a number of its own")
        self.check("ctypes" not in sys.modules, "what the server needs is not in the way")
        self.report(f"random: {random.random()}")
        pid = server()
        self.report("a server is there" if pid else "no server is there")
        if pid and "KILL_SERVER" in os.environ:
            os.kill(pid, 9)
"#;

fn run(suite: &str, fork: &str) -> Record {
    let folder = Folder::new();
    folder.file("T.lua", LUA).file("T.py", PYTHON).file("s.xml", suite);
    let finished = folder.rtf(&["run", "--fork", fork, "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(nothing_left(&folder));
    folder.journal().record
}

/// Of each test, whether it saw a server.
fn servers(record: &Record) -> Vec<bool> {
    let attempts = record.tests.iter().map(|test| &test.attempts[0]);
    attempts.map(|attempt| attempt.messages.iter().any(|m| m.text == "a server is there")).collect()
}

const THREE: &str =
    "<suite>\n  <test>T.lua</test>\n  <test>T.lua</test>\n  <test>T.lua</test>\n</suite>\n";

/// The same suite with tests in Python.
fn in_python(suite: &str) -> String {
    suite.replace("T.lua", "T.py")
}

#[test]
fn a_forked_host_looks_like_an_executed_one() {
    assert_eq!(servers(&run(THREE, "always")), [true; 3]);
}

#[test]
fn a_forked_python_looks_like_an_executed_one() {
    let record = run(&in_python(THREE), "always");
    assert_eq!(servers(&record), [true; 3]);
    let texts = record.tests.iter().flat_map(|test| &test.attempts[0].messages).map(|m| &m.text);
    let random: BTreeSet<_> = texts.filter(|text| text.starts_with("random: ")).collect();
    assert_eq!(random.len(), 3, "the same random numbers: {random:?}");
}

#[test]
fn python_is_forked_from_the_second_test_on_or_never() {
    let one = "<suite>\n  <test>T.py</test>\n</suite>\n";
    assert_eq!(servers(&run(one, "auto")), [false]);
    assert_eq!(servers(&run(&in_python(THREE), "never")), [false; 3]);
    assert!(servers(&run(&in_python(THREE), "auto"))[2]);
}

#[test]
fn each_environment_of_python_has_a_server_of_its_own() {
    let test = |value| format!("  <test>T.py<env name='PYTHONPATH' value='{value}'/></test>\n");
    let suite = format!("<suite>\n{0}{0}{1}{1}</suite>\n", test("modules"), test("others"));
    let folder = Folder::new();
    let module = "import os\nNAME = os.path.basename(os.path.dirname(os.path.abspath(__file__)))\n";
    let plugin = "import os\nimport rtf\nimport where\n\nclass T(rtf.TestCase):\n    def run(self):\n        \
                  wanted = os.environ['PYTHONPATH'].rpartition(':')[2]\n        \
                  self.check(where.NAME == wanted, f'{where.NAME} {wanted}')\n";
    folder.file("modules/where.py", module).file("others/where.py", module);
    folder.file("T.py", plugin).file("s.xml", &suite);
    let finished = folder.rtf(&["run", "--fork", "always", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(nothing_left(&folder));
}

/// `clone3` tells nobody that there is a fork, and some libraries want to be told.
#[test]
fn an_interpreter_with_libraries_that_are_told_of_forks_is_forked_in_two_steps() {
    let suite = in_python(THREE).replace("T.py", "T.py<env name='PYTHONPATH' value='site'/>");
    let folder = Folder::new();
    folder.file("site/sitecustomize.py", "import _hashlib\n");
    folder.file("T.py", PYTHON).file("s.xml", &suite);
    let finished = folder.rtf(&["run", "--fork", "always", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(servers(&folder.journal().record), [true; 3]);
    assert!(nothing_left(&folder));
}

#[test]
fn an_interpreter_that_starts_threads_by_itself_is_executed() {
    let suite = in_python(THREE).replace("T.py", "T.py<env name='PYTHONPATH' value='site'/>");
    let folder = Folder::new();
    let site =
        "import threading\nthreading.Thread(target=threading.Event().wait, daemon=True).start()\n";
    folder.file("site/sitecustomize.py", site).file("T.py", PYTHON).file("s.xml", &suite);
    let finished = folder.rtf(&["run", "--fork", "always", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(!servers(&folder.journal().record)[2]);
    assert!(nothing_left(&folder));
}

#[test]
fn forked_states_of_lua_have_random_numbers_of_their_own() {
    let folder = Folder::new();
    let plugin = "TestCase = {}\nfunction TestCase.run() rtf.report(math.random(1 << 60)) end\n";
    folder.file("T.lua", plugin).file("s.xml", THREE);
    let finished = folder.rtf(&["run", "--fork", "always", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    let numbers: BTreeSet<_> =
        record.tests.iter().map(|test| &test.attempts[0].messages[0].text).collect();
    assert_eq!(numbers.len(), 3, "{numbers:?}");
}

#[test]
fn the_first_host_is_executed_and_without_forks_all_are() {
    let one = "<suite>\n  <test>T.lua</test>\n</suite>\n";
    assert_eq!(servers(&run(one, "auto")), [false]);
    assert_eq!(servers(&run(THREE, "never")), [false; 3]);
    assert!(servers(&run(THREE, "auto"))[2]);
}

#[test]
fn a_preloaded_library_is_preloaded_by_executing_the_host() {
    let suite = THREE.replace("<suite>", "<suite>\n  <env name='LD_PRELOAD' value='libm.so.6'/>");
    assert_eq!(servers(&run(&suite, "always")), [false; 3]);
}

#[test]
fn without_its_server_a_host_is_executed() {
    let suite = THREE.replace("<suite>", "<suite>\n  <env name='KILL_SERVER' value='1'/>");
    let saw = servers(&run(&suite.replace("</suite>", "  <test>T.lua</test>\n</suite>"), "always"));
    assert_eq!((saw[0], saw[3]), (true, false), "{saw:?}");
}

#[test]
fn a_copy_of_a_forked_host_is_found_and_killed() {
    let plugins = build_cpp(&root().join("crates/rtf/tests/e2e/cpp"), "e2e-cpp");
    let folder = Folder::new();
    let test = format!("  <test leaks='fail'>{}</test>\n", plugins.join("Copy.so").display());
    folder.file("s.xml", &format!("<suite name='s'>\n{test}{test}</suite>\n"));
    let finished = folder.rtf(&["run", "--fork", "always", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    for (index, name) in [(0, "test s/Copy"), (1, "test s/Copy#2")] {
        assert_eq!(record.verdict(TestId(index)), Some(Verdict::Error));
        let left = &record.tests[TestId(index).index()].attempts[0].leaked;
        let owners: Vec<_> = left.iter().map(|process| process.owner.as_deref()).collect();
        assert_eq!(owners, [Some(name)]);
    }
    assert!(nothing_left(&folder));
}
