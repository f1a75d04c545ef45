//! Hosts that are forked from a server differ from executed ones in nothing
//! but their price.

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

fn run(suite: &str, fork: &str) -> Record {
    let folder = Folder::new();
    folder.file("T.lua", LUA).file("s.xml", suite);
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

#[test]
fn a_forked_host_looks_like_an_executed_one() {
    assert_eq!(servers(&run(THREE, "always")), [true; 3]);
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
        let left = &record.tests[TestId(index).index()].attempts[0].left;
        let owners: Vec<_> = left.iter().map(|process| process.owner.as_deref()).collect();
        assert_eq!(owners, [Some(name)]);
    }
    assert!(nothing_left(&folder));
}
