//! `rtf watch` with real files and real runs.

use std::fs::File;
use std::os::unix::process::CommandExt as _;
use std::process::Command;

use rtf_model::{EventKind, Phase, Record};

use crate::support::{Folder, Running, nothing_left, read_journal, wait_until};

const PASSES: &str = "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        pass\n";
const FAILS: &str =
    "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.fail('no')\n";
const PATIENT: &str =
    "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(1000)\n";
const FIXTURE: &str = "import rtf\nclass F(rtf.FixtureManager):\n    def setup(self, args):\n        return True\n    def tearDown(self):\n        open('torn-down', 'a').write('.')\n";
const SUITE: &str =
    "<suite name='s'><fixture type='python'>F</fixture><test type='python'>T</test></suite>";

/// A folder with a suite and its test.
fn folder(test: &str) -> Folder {
    let folder = Folder::new();
    folder.file("F.py", FIXTURE).file("T.py", test).file("s.xml", SUITE);
    folder
}

/// A watcher. It would outlive a test that fails.
struct Watcher(Option<Running>);

impl Watcher {
    fn running(&mut self) -> &mut Running {
        self.0.as_mut().expect("it runs")
    }

    fn finish(mut self) -> Option<i32> {
        self.0.take().expect("it runs").finish().code
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        if let Some(running) = &mut self.0 {
            // Its run is torn down by itself.
            let _ = running.child.kill();
            let _ = running.child.wait();
        }
    }
}

/// Starts the watcher as a shell in a terminal does, in a group of its own. Its
/// outputs are files, beside those that it watches.
fn watch(folder: &Folder, args: &[&str]) -> Watcher {
    let mut command = folder.command(&["watch", "s.xml"]);
    let output = |name| File::create(folder.path().join(name)).expect("a file");
    command.args(args).stdout(output("out")).stderr(output("err")).process_group(0);
    Watcher(Some(folder.watch(command.spawn().expect("rtf starts"))))
}

/// Waits until so many rounds have ended with this exit code.
fn wait_for_rounds(folder: &Folder, code: u8, rounds: usize) {
    let line = format!("rtf watch: exit code {code}; waiting for changes in ");
    wait_until(&format!("{rounds} times {line}"), || {
        (folder.read("err").matches(&line).count() >= rounds).then_some(())
    });
}

/// The runs, in their order.
fn runs(folder: &Folder) -> Vec<Record> {
    let entries = std::fs::read_dir(folder.path().join("rtf-results")).expect("results").flatten();
    let paths = entries.map(|entry| entry.path().join("events.jsonl"));
    let runs = paths.filter(|path| path.is_file() && !path.to_string_lossy().contains("/latest/"));
    let mut runs: Vec<_> = runs.map(|path| read_journal(&path).record).collect();
    runs.sort_by_key(|run| run.run.as_ref().map(|started| started.started_at.clone()));
    runs
}

fn is_in_run(kind: &EventKind) -> bool {
    matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. })
}

fn torn_down(folder: &Folder) -> usize {
    std::fs::read(folder.path().join("torn-down")).map_or(0, |dots| dots.len())
}

fn signal_group(running: &Running, signal: &str) {
    let group = format!("-{}", running.child.id());
    let status = Command::new("kill").args(["-s", signal, "--", &group]).status();
    assert!(status.expect("kill").success());
}

#[test]
fn a_changed_plugin_runs_again_and_nothing_else_does() {
    let folder = folder(PASSES);
    let mut watcher = watch(&folder, &["--report", "junit=junit.xml"]);
    wait_for_rounds(&folder, 0, 1);
    folder.file("notes.txt", "not used").file("rtf-results/T.py", FAILS);
    folder.file("T.py", FAILS);
    wait_for_rounds(&folder, 1, 1);
    // As editors do: what is new takes the place of what was there.
    folder.file("T.py.new", PASSES);
    let path = |name| folder.path().join(name);
    std::fs::rename(path("T.py"), path("T.py~")).expect("renamed");
    std::fs::rename(path("T.py.new"), path("T.py")).expect("renamed");
    wait_for_rounds(&folder, 0, 2);
    watcher.running().signal("INT");
    assert_eq!(watcher.finish(), Some(130), "nothing runs: it ends at once");
    let green: Vec<_> = runs(&folder).iter().map(Record::is_green).collect();
    assert_eq!(green, [true, false, true]);
    assert_eq!(folder.read("err").matches("T.py changed; rerunning").count(), 2);
    assert!(nothing_left(&folder));
}

#[test]
fn a_change_stops_the_run_and_starts_the_next_one() {
    let folder = folder(PATIENT);
    let mut watcher = watch(&folder, &[]);
    watcher.running().wait_for(is_in_run);
    folder.file("T.py", PASSES);
    wait_for_rounds(&folder, 0, 1);
    assert_eq!(torn_down(&folder), 2, "by the stopped run, too");
    let runs = runs(&folder);
    let interrupted: Vec<_> = runs.iter().map(Record::interrupted).collect();
    assert_eq!(interrupted, [Some("SIGTERM"), None]);
    assert!(runs.iter().all(Record::is_complete));
    assert!(folder.read("err").contains("T.py changed; stopping the run, then rerunning"));
    watcher.running().signal("TERM");
    assert_eq!(watcher.finish(), Some(143));
}

#[test]
fn mistakes_are_told_and_can_be_repaired() {
    let folder = folder(PASSES);
    std::fs::remove_file(folder.path().join("T.py")).expect("removed");
    let mut watcher = watch(&folder, &[]);
    wait_for_rounds(&folder, 2, 1);
    assert!(folder.read("err").contains("--> s.xml:1:"), "{}", folder.read("err"));
    folder.file("T.py", PASSES);
    wait_for_rounds(&folder, 0, 1);
    folder.file("s.xml", "<suite name='s'><tset/></suite>");
    wait_for_rounds(&folder, 2, 2);
    folder.file("rtf.toml", "nonsense = 1\n").file("s.xml", SUITE);
    wait_for_rounds(&folder, 2, 3);
    std::fs::remove_file(folder.path().join("rtf.toml")).expect("removed");
    wait_for_rounds(&folder, 0, 2);
    watcher.running().signal("INT");
    assert_eq!(watcher.finish(), Some(130));
    assert_eq!(runs(&folder).len(), 2, "suites with mistakes are not run");
}

#[test]
fn a_folder_is_built_anew_and_gets_another_test() {
    let folder = folder(PASSES);
    folder
        .file("build/T.py", PASSES)
        .file("s.xml", "<suite><test type='python'>build/T</test></suite>");
    folder.file("more/U.py", PASSES);
    let mut watcher = watch(&folder, &["more"]);
    wait_for_rounds(&folder, 0, 1);
    std::fs::remove_dir_all(folder.path().join("build")).expect("removed");
    wait_for_rounds(&folder, 2, 1);
    folder.file("build/T.py", FAILS);
    wait_for_rounds(&folder, 1, 1);
    folder.file("build/T.py", PASSES);
    wait_for_rounds(&folder, 0, 2);
    folder.file("more/V.py", FAILS);
    wait_for_rounds(&folder, 1, 2);
    watcher.running().signal("INT");
    assert_eq!(watcher.finish(), Some(130));
    assert_eq!(runs(&folder).last().map(|run| run.tests.len()), Some(3));
}

#[test]
fn a_terminals_ctrl_c_ends_the_run_in_order() {
    let folder = folder(PATIENT);
    let mut watcher = watch(&folder, &[]);
    watcher.running().wait_for(is_in_run);
    // The run is in another group: what it gets is passed on, once.
    signal_group(watcher.running(), "INT");
    assert_eq!(watcher.finish(), Some(130));
    assert_eq!(torn_down(&folder), 1);
    assert_eq!(folder.journal().record.interrupted(), Some("SIGINT"));
    assert!(nothing_left(&folder));
}

#[test]
fn a_killed_watcher_leaves_nothing() {
    let folder = folder(PATIENT);
    let mut watcher = watch(&folder, &[]);
    watcher.running().wait_for(is_in_run);
    watcher.running().child.kill().expect("the watcher is killed");
    assert_eq!(watcher.finish(), None);
    wait_until("the end of the run", || nothing_left(&folder).then_some(()));
    assert_eq!(torn_down(&folder), 1);
    assert_eq!(folder.journal().record.interrupted(), Some("SIGTERM"));
}
