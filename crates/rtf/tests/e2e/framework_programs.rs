//! Programs of other frameworks, with a script that behaves like a hanging GoogleTest
//! program. The corpora in tests/frameworks have real ones.

use std::path::Path;

use rtf_model::{EventKind, Verdict};

use crate::support::{Folder, Running, nothing_left, wait_until};

/// Lists a test; otherwise it hangs.
const HANGS: &str = r#"#!/bin/sh
for argument; do case $argument in --gtest_output=json:*) file=${argument#*:};; esac; done
case " $* " in
*--gtest_list_tests*)
  echo '{"testsuites": [{"name": "Arm", "testsuite": [{"name": "Hangs"}]}]}' >"$file" ;;
*)
  echo hangs
  sleep 600 ;;
esac
"#;

fn folder() -> Folder {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = Folder::new();
    folder.file("arm_test", HANGS);
    folder.file("s.xml", "<suite name='s'><test type='gtest'>arm_test</test></suite>");
    let program = folder.path().join("arm_test");
    std::fs::set_permissions(program, std::fs::Permissions::from_mode(0o755)).expect("a program");
    std::fs::create_dir(folder.path().join("tmp")).expect("a folder");
    folder
}

/// Starts the run with a separate directory for temporary files, until the program hangs.
fn start(folder: &Folder) -> Running {
    let mut command = folder.command(&["run", "s.xml"]);
    command.env("TMPDIR", folder.path().join("tmp"));
    let running = folder.start_command(command);
    running.wait_for(hangs);
    running
}

fn is_empty(dir: &Path) -> bool {
    std::fs::read_dir(dir).expect("a folder").next().is_none()
}

fn hangs(kind: &EventKind) -> bool {
    matches!(kind, EventKind::Output(output) if output.text.contains("hangs"))
}

#[test]
fn a_killed_runner_leaves_no_program_and_no_file_of_it() {
    let folder = folder();
    let running = start(&folder);
    running.kill_runner();
    assert_eq!(running.finish().code, Some(5));
    wait_until("the end of all processes", || nothing_left(&folder).then_some(()));
    assert!(is_empty(&folder.path().join("tmp")));
}

#[test]
fn an_interrupted_program_ends_and_leaves_no_file() {
    let folder = folder();
    let running = start(&folder);
    running.signal("INT");
    assert_eq!(running.finish().code, Some(130));
    assert!(nothing_left(&folder));
    let journal = folder.journal();
    assert_eq!(journal.record.tests[0].verdict(), Some(Verdict::Interrupted));
    assert!(is_empty(&folder.path().join("tmp")));
}
