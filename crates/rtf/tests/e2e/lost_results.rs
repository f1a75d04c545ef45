//! Results are removed or damaged during the run: the run is not green, and its outcome is
//! printed.

use crate::support::{Finished, Folder};

/// A test that passed, one that does `act` to the results, and one that fails.
fn run(act: &str, args: &[&str]) -> (Folder, Finished) {
    let folder = Folder::new();
    folder.file("Good.lua", "function TestCase.run() rtf.report('fine') end");
    folder.file("Acts.lua", &format!("function TestCase.run() assert(os.execute([[{act}]])) end"));
    folder.file("Bad.lua", "function TestCase.run() rtf.fail('the arm is stuck') end");
    let tests = "<test>Good.lua</test><test>Acts.lua</test><test>Bad.lua</test>";
    folder.file("s.xml", &format!("<suite name='s'>{tests}</suite>"));
    let done = folder.rtf(&[&["run", "s.xml"], args].concat());
    (folder, done)
}

fn told(act: &str, why: &str) -> Folder {
    let (folder, done) = run(act, &[]);
    let all = format!("{}{}", done.stdout, done.stderr);
    assert_eq!(done.code, Some(3), "{act}: {all}");
    assert!(done.stdout.contains("NOT WRITTEN"), "{act}: it is said at once: {all}");
    let said = format!("caused by: {why}");
    assert!(done.stderr.contains(&said), "{act}: {all}");
    // What is known comes from memory.
    assert!(done.stdout.contains("s/Bad  failed"), "{act}: {all}");
    assert!(done.stdout.contains("the arm is stuck"), "{act}: {all}");
    assert!(done.stdout.contains("2 passed, 1 failed"), "{act}: {all}");
    folder
}

#[test]
fn results_that_a_test_removes_are_missed() {
    told("rm -r rtf-results", "it was removed during the run");
    told("rm rtf-results/latest/events.jsonl", "it was removed during the run");
}

#[test]
fn results_that_a_test_moves_are_missed() {
    told("mv rtf-results elsewhere", "it was moved during the run");
    told("mkdir away; mv rtf-results/2* away", "it was moved during the run");
}

#[test]
fn a_journal_that_a_test_cuts_or_appends_to_is_noticed() {
    let folder = told(": > rtf-results/latest/events.jsonl", "it has 0 bytes instead of");
    let shown = folder.rtf(&["show", "latest"]);
    assert!(matches!(shown.code, Some(1 | 2)), "{}", shown.stdout);
    let folder = told("echo >> rtf-results/latest/events.jsonl", "it has ");
    let shown = folder.rtf(&["show", "latest"]);
    assert_eq!(shown.code, Some(1));
    assert!(shown.stdout.contains("DAMAGED"), "{}", shown.stdout);
}

/// Standard output is data then.
#[test]
fn results_that_vanish_are_told_of_on_standard_error_where_output_is_data() {
    for format in ["json", "tap"] {
        let (_, done) = run("rm -r rtf-results", &["--format", format]);
        assert_eq!(done.code, Some(3), "{}", done.stderr);
        assert!(done.stderr.contains("it was removed during the run"), "{}", done.stderr);
        assert!(done.stdout.contains("the arm is stuck"), "{}", done.stdout);
    }
}

/// A report elsewhere is made from what is known.
#[test]
fn reports_elsewhere_are_written_although_the_results_vanished() {
    let (folder, done) = run("rm -r rtf-results", &["--report", "junit=junit.xml"]);
    assert_eq!(done.code, Some(3), "{}", done.stderr);
    assert!(folder.read("junit.xml").contains("the arm is stuck"));
}

/// A results disk that is full is named when it is full, and the run goes on.
#[test]
fn a_full_disk_is_named_at_once() {
    let folder = Folder::new();
    folder.file(
        "Fills.lua",
        "function TestCase.run() for i = 1, 40000 do rtf.report('0123456789') end end",
    );
    folder.file("Bad.lua", "function TestCase.run() rtf.fail('the arm is stuck') end");
    folder.file("s.xml", "<suite name='s'><test>Fills.lua</test><test>Bad.lua</test></suite>");
    folder.file("disk/.keep", "");
    let script = "mount -t tmpfs -o size=512k none disk && exec \"$@\"";
    let mut command = std::process::Command::new("unshare");
    command.args(["-Urm", "sh", "-c", script, "sh", env!("CARGO_BIN_EXE_rtf")]);
    command.args(["run", "s.xml", "--results", "disk/results"]);
    command.current_dir(folder.path()).env("NO_COLOR", "1").stdin(std::process::Stdio::null());
    let done = Finished::of(command.output().expect("unshare"));
    let all = format!("{}{}", done.stdout, done.stderr);
    assert_eq!(done.code, Some(3), "{all}");
    let said = done.stdout.find("NOT WRITTEN  the journal `disk/results/").expect("it is said");
    let failed = done.stdout.find("s/Bad").expect("the run goes on");
    assert!(said < failed, "{all}");
    assert!(done.stdout.contains("No space left on device"), "{all}");
    assert!(done.stderr.contains("No space left on device"), "{all}");
}
