//! Values that fixtures provide: a simulator that picks its own port, with its users.

use std::path::Path;

use rtf_model::{EventKind, HookId, Phase, TestId, Verdict, value_text};

use crate::support::{Finished, Folder, Journal, nothing_left};

/// A server that picks its own port, and a new one after each restart. Its arguments are
/// lines that it prints after the port.
const SIMULATOR: &str = "import os, socket, sys, time\n\
server = socket.create_server(('127.0.0.1', 0))\n\
port = server.getsockname()[1]\n\
open('sim.pid', 'w').write(str(os.getpid()))\n\
with open('ports.txt', 'a') as ports: ports.write(f'{port}\\n')\n\
print(f'arm on port {port}', flush=True)\n\
for line in sys.argv[1:]: print(line, flush=True)\n\
while True: server.accept()\n";
/// Writes the values that it gets to a file, after it has connected.
const TEST: &str = "import os, rtf, socket\n\
class T(rtf.TestCase):\n    def run(self):\n        \
port = os.environ['RTF_FIXTURE_SIM_PORT']\n        \
assert self.param == f'--port {port}', self.param\n        \
socket.create_connection(('127.0.0.1', int(port))).close()\n        \
with open('tests.txt', 'a') as file: file.write(f'{port}\\n')\n";
const PORT: &str = "<provide name='port' log='on port (\\d+)'/>";

fn folder(fixture: &str, more: &str, tests: &str) -> Folder {
    let folder = Folder::new();
    folder.file("sim.py", SIMULATOR).file("T.py", TEST).file("s.xml", &suite(fixture, more, tests));
    folder
}

fn suite(fixture: &str, more: &str, tests: &str) -> String {
    format!(
        "<suite name='s'><fixture type='process' name='sim' timeout='20s' restarts='1'>\
         <command>python3 sim.py</command>{fixture}</fixture>{more}{tests}</suite>"
    )
}

fn lines(folder: &Folder, name: &str) -> Vec<String> {
    let text = std::fs::read_to_string(folder.path().join(name)).unwrap_or_default();
    text.lines().map(str::to_owned).collect()
}

/// The texts of all values in a journal, in their order.
fn provided(journal: &Journal) -> Vec<(String, Option<String>)> {
    let values = journal.events.iter().filter_map(|event| match &event.kind {
        EventKind::FixtureProvided(it) => {
            Some((it.name.clone(), it.value.as_ref().map(|value| value_text(value).into_owned())))
        }
        _ => None,
    });
    values.collect()
}

fn passed(finished: &Finished) {
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
}

#[test]
fn a_port_that_the_simulator_picks_reaches_fixtures_tests_and_hooks() {
    let driver = "<fixture type='process' name='driver'>\
         <command>sh -c 'echo driver $0 $RTF_FIXTURE_SIM_PORT; exec sleep 1000' ${fixture:sim.port}</command>\
         <alive tcp='127.0.0.1:${fixture:sim.port}'/><env name='AT' value='${fixture:sim.port}'/>\
         <provide name='seen' command='sh -c \"echo $AT\"'/></fixture>";
    let hook = "<hook name='park' on='end'>\
         <command>sh -c 'echo $0 $RTF_FIXTURE_SIM_PORT $RTF_FIXTURE_DRIVER_SEEN > hook.txt' ${fixture:sim.port}</command></hook>";
    let test = "<test type='python' param='--port ${fixture:sim.port}'>T</test>";
    let pid = "<provide name='pid' file='sim.pid'/>";
    let folder = folder(&format!("{PORT}{pid}"), &format!("{driver}{hook}"), test);
    folder.file("sim.pid", "1");
    passed(&folder.rtf(&["run", "s.xml"]));
    let port = lines(&folder, "ports.txt").remove(0);
    assert_eq!(lines(&folder, "tests.txt"), [port.as_str()]);
    assert_eq!(lines(&folder, "hook.txt"), [format!("{port} {port} {port}")]);
    let journal = folder.journal();
    let values = provided(&journal);
    let named = |name: &str| values.iter().find(|(known, _)| known == name).unwrap().1.clone();
    assert_eq!((named("port"), named("seen")), (Some(port.clone()), Some(port.clone())));
    assert_eq!(named("pid"), Some(lines(&folder, "sim.pid").remove(0)));
    assert_eq!(journal.record.fixtures[0].values.len(), 2);
    assert!(nothing_left(&folder));
}

#[test]
fn a_restarted_simulator_provides_its_new_port_in_every_mode_of_a_test() {
    for isolation in ["process", "shared"] {
        let test = format!(
            "<test type='python' isolation='{isolation}' name='before' param='--port ${{fixture:sim.port}}'>T</test>\
             <test type='python' isolation='{isolation}' name='kills' after-collapse='rerun'>Kills</test>\
             <test type='python' isolation='{isolation}' name='after' param='--port ${{fixture:sim.port}}'>T</test>"
        );
        let folder = folder(PORT, "", &test);
        folder.file("Kills.py", "import os, rtf\nclass T(rtf.TestCase):\n    def run(self):\n        if os.path.exists('killed'): return\n        open('killed', 'w').close()\n        os.kill(int(open('sim.pid').read()), 9)\n        self.sleep(1000)\n");
        let finished = folder.rtf(&["run", "s.xml"]);
        assert_eq!(finished.code, Some(1), "the collapse is told: {}", finished.stdout);
        let ports = lines(&folder, "ports.txt");
        assert_eq!(lines(&folder, "tests.txt"), ports, "{}", finished.stdout);
        assert_eq!(ports.len(), 2);
        let record = folder.journal().record;
        assert!((0..3).all(|test| record.verdict(TestId(test)) == Some(Verdict::Passed)));
    }
}

#[test]
fn an_idle_shared_host_is_not_reused_after_the_values_have_changed() {
    let test = "<test type='python' isolation='shared' name='before' param='--port ${fixture:sim.port}'>T</test>\
                <test type='python' isolation='shared' name='after' param='--port ${fixture:sim.port}'>T</test>";
    let folder = folder(PORT, "<fixture name='killer' type='python'>Killer</fixture>", test);
    folder.file("Killer.py", "import os, rtf, time\nclass F(rtf.FixtureManager):\n    def setup(self, *args): pass\n    def testFinished(self, test, verdict, reason):\n        if test.name == 'before':\n            os.kill(int(open('sim.pid').read()), 9)\n            time.sleep(0.5)\n    def tearDown(self): pass\n");
    let finished = folder.rtf(&["run", "s.xml"]);
    let ports = lines(&folder, "ports.txt");
    assert_eq!(ports.len(), 2, "{}", finished.stdout);
    assert_eq!(lines(&folder, "tests.txt").last(), ports.last(), "{}", finished.stdout);
    assert_eq!(folder.journal().record.verdict(TestId(1)), Some(Verdict::Passed));
}

#[test]
fn a_declared_value_that_is_missing_breaks_the_fixture() {
    let cases = [
        (
            "<provide name='pose' log='pose (.*)'/>",
            "it was not ready within 5s: it did not provide `pose`: no line matched `pose (.*)`",
        ),
        (
            "<provide name='pose' file='pose.txt'/>",
            "it was not ready within 5s: it did not provide `pose`: no file ROOT/pose.txt: No such file or directory (os error 2)",
        ),
        (
            "<provide name='pose' file='empty.txt'/>",
            "it was not ready within 5s: it did not provide `pose`: ROOT/empty.txt is from before the start",
        ),
        (
            "<provide name='pose' command='false'/>",
            "it was not ready within 5s: it did not provide `pose`: `false` ended with exit code 1",
        ),
        (
            "<provide name='pose' command='true'/>",
            "it was not ready within 5s: it did not provide `pose`: `true` is empty",
        ),
    ];
    for (provide, reason) in cases {
        let folder = folder(provide, "", "<test type='python'>T</test>");
        folder.file("empty.txt", "");
        let text = folder.read("s.xml").replace("'20s' restarts='1'", "'5s' restarts='0'");
        folder.file("s.xml", &text);
        let finished = folder.rtf(&["run", "s.xml"]);
        assert_eq!(finished.code, Some(1));
        let record = folder.journal().record;
        let reason = reason.replace("ROOT", &folder.path().to_string_lossy());
        assert_eq!(
            record.fixtures[0].broken.as_deref(),
            Some(&*format!("set-up failed: {reason}"))
        );
    }
    let folder = Folder::new();
    folder.file("T.py", TEST).file(
        "F.py",
        "import rtf\nclass F(rtf.FixtureManager):\n    def setup(self, *args): pass\n    def tearDown(self): pass\n",
    );
    folder.file("s.xml", "<suite><fixture name='f' type='python' restarts='0'>F<provide name='port'/></fixture><test type='python'>T</test></suite>");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let broken = folder.journal().record.fixtures[0].broken.clone();
    assert_eq!(broken.as_deref(), Some("set-up failed: it did not provide `port`"));
}

#[test]
fn invalid_values_break_the_fixture_with_one_clear_message() {
    let python = |code: &str| format!("<provide name='v' command='python3 -c \"{code}\"'/>");
    let cases = [
        (python("print(10_000_000 * &apos;x&apos;)"), "the value of `v` has more than 65536 bytes"),
        (python("print(&apos;a\\0b&apos;)"), "the value of `v` contains a NUL character"),
        (
            "<provide name='v' command='echo abc' secret='true'/>".to_owned(),
            "the secret `v` is not one line of at least 4 characters",
        ),
        (
            "<provide name='v' command='printf &quot;abcd\\nefgh&quot;' secret='true'/>".to_owned(),
            "the secret `v` is not one line of at least 4 characters",
        ),
    ];
    for (provide, reason) in cases {
        let folder = folder(&provide, "", "<test type='python'>T</test>");
        assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
        let journal = folder.journal();
        let broken = journal.record.fixtures[0].broken.as_deref();
        assert_eq!(broken, Some(&*format!("set-up failed: {reason}")));
        assert!(provided(&journal).is_empty());
    }
}

fn files(dir: &Path, found: &mut Vec<(String, Vec<u8>)>) {
    for entry in std::fs::read_dir(dir).expect("a directory").flatten() {
        match entry.file_type().expect("a type") {
            kind if kind.is_dir() => files(&entry.path(), found),
            kind if kind.is_file() => {
                let name = entry.path().to_string_lossy().into_owned();
                found.push((name, std::fs::read(entry.path()).expect("a file")));
            }
            _ => {}
        }
    }
}

#[test]
fn a_secret_reaches_its_users_and_no_file_and_no_screen() {
    const SECRET: &str = "hunter-7c1f";
    let folder = Folder::new();
    folder.file("sim.py", SIMULATOR).file("T.py", "import os, rtf, sys\nclass T(rtf.TestCase):\n    def run(self):\n        token = os.environ['RTF_FIXTURE_SIM_TOKEN']\n        print('printed', token, flush=True)\n        sys.stdout.write(token[:5]); sys.stdout.flush(); self.sleep(0.05); print(token[5:])\n        self.report('token ' + token)\n        self.report('length %d param %s' % (len(token), self.param == token))\n        with self.case(token): self.fail('refused ' + token)\n");
    folder.file("s.xml", &format!("<suite name='s'><fixture type='process' name='sim'><command>python3 sim.py 'token: {}'</command>\
        <provide name='token' log='token: (\\S+)' secret='true'/></fixture>\
        <hook name='park' on='failure'><command>sh -c 'echo \"$RTF_HOOK_REASON\" $0; echo $RTF_FIXTURE_SIM_TOKEN; exit 3' ${{fixture:sim.token}}</command></hook>\
        <test type='python' param='${{fixture:sim.token}}'>T</test></suite>", "@"));
    // The suite itself must not contain it: the simulator is the only one that knows it.
    let suite = folder.read("s.xml").replace("python3 sim.py 'token: @'", "python3 sim.py");
    folder.file("s.xml", &suite);
    let sim = SIMULATOR.replace("for line in sys.argv[1:]: print(line, flush=True)", "secret = 'hunter-' + '7c1f'\nsys.stdout.write('token: ' + secret[:6]); sys.stdout.flush(); time.sleep(0.1); print(secret[6:], flush=True)");
    assert!(sim.contains("hunter"), "the simulator has the secret");
    folder.file("sim.py", &sim);
    let reports = ["junit=junit.xml", "text=report.txt", "tap=report.tap", "github=github.txt"];
    let reports = reports.iter().flat_map(|report| ["--report", report]);
    let args: Vec<&str> = ["run", "s.xml", "-v"].into_iter().chain(reports).collect();
    let finished = folder.rtf(&args);
    assert_eq!(finished.code, Some(4), "the hook failed: {}", finished.stdout);
    let shown = format!("{}{}", finished.stdout, finished.stderr);
    assert!(!shown.contains(SECRET), "{shown}");
    for expected in
        ["printed ***", "token ***", "length 11 param True", "refused ***", "token: ***"]
    {
        assert!(shown.contains(expected), "`{expected}` in {shown}");
    }
    let mut found = Vec::new();
    files(folder.path(), &mut found);
    assert!(found.iter().any(|(name, _)| name.ends_with("events.jsonl")), "{:?}", found.len());
    for (name, bytes) in found {
        let shows = bytes.windows(SECRET.len()).any(|window| window == SECRET.as_bytes());
        assert!(!shows, "{name} contains the secret");
    }
    assert_eq!(provided(&folder.journal()), [("token".to_owned(), None)]);
}

#[test]
fn a_secret_is_not_shown_if_the_program_ends_in_the_middle_of_its_line() {
    let folder = Folder::new();
    folder.file(
        "sim.py",
        "import sys\nsys.stdout.write('token: ' + 'hunter-' + '7c1f')\nsys.exit(3)\n",
    );
    folder.file("T.py", TEST).file("s.xml", "<suite><fixture type='process' name='sim' restarts='0'><command>python3 sim.py</command>\
        <provide name='token' log='token: (\\S+)' secret='true'/></fixture><test type='python'>T</test></suite>");
    let finished = folder.rtf(&["run", "s.xml", "-v"]);
    let shown = format!("{}{}", finished.stdout, finished.stderr);
    assert!(!shown.contains("7c1f") && shown.contains("token: ***"), "{shown}");
}

#[test]
fn an_invalid_value_in_an_incomplete_last_line_breaks_the_fixture() {
    let folder = Folder::new();
    folder.file("sim.py", "import sys\nsys.stdout.write('token: abc')\n");
    folder.file("T.py", TEST).file("s.xml", "<suite><fixture type='process' name='sim' restarts='0'><command>python3 sim.py</command>\
        <provide name='token' log='token: (\\S+)' secret='true'/></fixture><test type='python'>T</test></suite>");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let broken = folder.journal().record.fixtures[0].broken.clone();
    let reason = "set-up failed: the secret `token` is not one line of at least 4 characters";
    assert_eq!(broken.as_deref(), Some(reason));
}

#[test]
fn the_guard_gives_the_values_to_its_hooks() {
    let hook = "<hook name='park' on='interrupt'>\
         <command>sh -c 'echo $0 $RTF_FIXTURE_SIM_PORT > hook.txt' ${fixture:sim.port}</command></hook>";
    let folder = folder(PORT, hook, "<test type='python'>Patient</test>");
    folder.file(
        "Patient.py",
        "import rtf\nclass T(rtf.TestCase):\n    def run(self): self.sleep(1000)\n",
    );
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    running.kill_runner();
    assert_eq!(running.finish().code, Some(5));
    let port = lines(&folder, "ports.txt").remove(0);
    assert_eq!(lines(&folder, "hook.txt"), [format!("{port} {port}")]);
    assert!(nothing_left(&folder));
}

#[test]
fn a_hook_without_its_value_does_not_run_and_fails() {
    let hook = "<hook name='park' on='fixture-broken end'>\
         <command>touch ran-${fixture:sim.pose}</command></hook>";
    let folder =
        folder("<provide name='pose' command='false'/>", hook, "<test type='python'>T</test>");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(4), "{}", finished.stdout);
    let journal = folder.journal();
    let problems: Vec<_> = journal.record.hooks[HookId(0).index()].problems().collect();
    let problem = "it needs `${fixture:sim.pose}`, which was not provided";
    assert!(problems.iter().all(|found| found.contains(problem)), "{problems:?}");
    assert!(!problems.is_empty());
}

#[test]
fn check_reports_unknown_references() {
    let folder = folder(PORT, "", "<test type='python' param='${fixture:sim.prot}'>T</test>");
    let finished = folder.rtf(&["check", "s.xml"]);
    assert_eq!(finished.code, Some(2), "{}", finished.stdout);
    let shown = format!("{}{}", finished.stdout, finished.stderr);
    assert!(shown.contains("the fixture `sim` declares no value `prot`"), "{shown}");
    assert!(shown.contains("did you mean `port`?"), "{shown}");
}
