//! Tests of a campaign that share a host: one process for all episodes, until one of them crashes.

use rtf_model::EpisodeOutcome;

use crate::campaign::{results, run};
use crate::support::{Folder, build_cpp, nothing_left, root};

const LUA: &str = "TestCase = {}\nlocal param\n\
    function TestCase.setup(args) param = args[1] end\n\
    function TestCase.run()\n  \
    local payload, stat = os.getenv('RTF_PARAM_PAYLOAD'), io.open('/proc/self/stat')\n  \
    local log = io.open('log', 'a')\n  \
    log:write(stat:read('n'), ' ', os.getenv('RTF_EPISODE'), ' ', payload, ' ', param, '\\n')\n  \
    log:close()\n  \
    if payload == '9' then os.exit(4) end\n  \
    rtf.check(tonumber(payload) < 2, 'too heavy')\nend\n";

const PYTHON: &str = "import os\nimport rtf\n\n\nclass Grasp(rtf.TestCase):\n    def run(self):\n        \
    payload = os.environ['RTF_PARAM_PAYLOAD']\n        \
    with open('log', 'a') as log:\n            \
    print(os.getpid(), os.environ['RTF_EPISODE'], payload, self.param, file=log)\n        \
    if payload == '9':\n            os.abort()\n        \
    self.check(float(payload) < 2, 'too heavy')\n";

const RUBY: &str = "class Grasp < RTF::TestCase\n  def run\n    \
    payload = ENV.fetch('RTF_PARAM_PAYLOAD')\n    \
    text = [Process.pid, ENV.fetch('RTF_EPISODE'), payload, param].join(' ')\n    \
    File.write('log', \"#{text}\\n\", mode: 'a')\n    \
    Process.kill(:ABRT, Process.pid) if payload == '9'\n    \
    check(payload.to_f < 2, 'too heavy')\n  end\nend\n";

/// Of one worker: the process, the episode, the variable and the parameter of each test.
fn log(folder: &Folder) -> Vec<Vec<String>> {
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect();
    folder.read("log").lines().map(words).collect()
}

fn campaign(file: &str, values: &str, more: &str) -> Folder {
    let folder = Folder::new();
    folder.file("Grasp.lua", LUA).file("Grasp.py", PYTHON).file("Grasp.rb", RUBY);
    let test = format!("<test isolation='shared' param='${{param:payload}}'>{file}</test>");
    folder.file("grasp.xml", &format!("<suite name='grasp'>{more}{test}</suite>"));
    let parameter = format!("<parameter name='payload' distribution='grid' values='{values}'/>");
    let claim = "<claim require='rate &gt;= 0.1' confidence='0.6'/>";
    folder.file(
        "campaign.xml",
        &format!("<campaign suite='grasp.xml'>{parameter}{claim}</campaign>"),
    );
    folder
}

/// Each episode has its own parameters, and one that fails does not end the host.
#[test]
fn one_process_runs_all_episodes_in_each_language() {
    let cpp = build_cpp(&root().join("crates/rtf/tests/e2e/cpp"), "e2e-cpp").join("Grasp.so");
    let cpp = cpp.display().to_string();
    for file in ["Grasp.lua", "Grasp.py", "Grasp.rb", &cpp] {
        let folder = campaign(file, "0 1 5 1.5 0.5", "");
        let finished = run(&folder, &[]);
        assert_eq!(finished.code, Some(0), "{file}: {}{}", finished.stdout, finished.stderr);
        let log = log(&folder);
        let pid = log[0][0].clone();
        let expected = ["0", "1", "5", "1.5", "0.5"].iter().zip(1..);
        let expected = expected.map(|(value, id)| format!("{pid} {id} {value} {value}"));
        let lines: Vec<_> = log.iter().map(|words| words.join(" ")).collect();
        assert_eq!(lines, expected.collect::<Vec<_>>(), "{file}");
        use EpisodeOutcome::{Failed, Passed};
        let outcomes: Vec<_> = results(&folder).iter().filter_map(|line| line.outcome).collect();
        assert_eq!(outcomes, [Passed, Passed, Failed, Passed, Passed], "{file}");
        assert!(nothing_left(&folder));
    }
}

/// A crash costs the episode that ran.
#[test]
fn after_a_crash_the_next_episode_has_a_new_process() {
    for file in ["Grasp.lua", "Grasp.py"] {
        let folder = campaign(file, "0 9 1 0.5", "");
        run(&folder, &[]);
        let log = log(&folder);
        let pids: Vec<_> = log.iter().map(|words| &words[0]).collect();
        assert!(pids[0] == pids[1] && pids[1] != pids[2] && pids[2] == pids[3], "{file}: {log:?}");
        use EpisodeOutcome::{Failed, Passed};
        let outcomes: Vec<_> = results(&folder).iter().filter_map(|line| line.outcome).collect();
        assert_eq!(outcomes, [Passed, Failed, Passed, Passed], "{file}");
        assert!(nothing_left(&folder));
    }
}

/// The host outlives the reset of a fixture between the episodes.
#[test]
fn a_host_outlives_the_reset_of_a_fixture() {
    let fixture = "<fixture name='sim' type='process'>\
        <command>sh -c 'echo up; exec sleep 1000'</command><ready log='up'/>\
        <reset command='true'/></fixture>";
    let folder = campaign("Grasp.lua", "0 1 5 1.5", fixture);
    assert_eq!(run(&folder, &[]).code, Some(0));
    let log = log(&folder);
    assert!(log.iter().all(|words| words[0] == log[0][0]), "{log:?}");
    assert_eq!(log.len(), 4);
    assert!(nothing_left(&folder));
}
