//! The terminal is closed while `rtf run` writes to it: SIGHUP and a broken pipe are not errors
//! of `rtf`.

use std::process::Command;

use crate::support::{Folder, nothing_left};

/// Runs a command in a terminal, closes that when a line says so, and prints the
/// command's exit code, negative for a signal.
const TERMINAL: &str = r"
import os, pty, sys
pid, terminal = pty.fork()
if pid == 0:
    os.execv(sys.argv[2], sys.argv[2:])
seen = b''
while sys.argv[1].encode() not in seen:
    seen += os.read(terminal, 1)
os.close(terminal)
print(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
";

fn closed_at(folder: &Folder, line: &str, args: &[&str]) -> String {
    let mut command = Command::new("python3");
    command.args(["-c", TERMINAL, line, env!("CARGO_BIN_EXE_rtf")]).args(args);
    command.current_dir(folder.path()).env("CI", "1");
    let output = command.output().expect("python3");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    String::from_utf8_lossy(&output.stdout).trim().to_owned()
}

#[test]
fn a_closed_terminal_is_a_hangup_for_the_run_and_for_who_shows_it() {
    let folder = Folder::new();
    let test = "function TestCase.run() for i = 1, 300 do rtf.report('step ' .. i) rtf.sleep(0.01) end end";
    folder.file("T.lua", test);
    folder.file("s.xml", &format!("<suite name='s'>{}</suite>", "<test>T.lua</test>".repeat(3)));
    let run = closed_at(&folder, "step 20", &["run", "-v", "s.xml"]);
    assert_eq!(run, "129", "interrupted by SIGHUP, and no error of its own");
    assert!(nothing_left(&folder));
    let record = folder.journal().record;
    assert_eq!(record.interrupted(), Some("SIGHUP"));
    assert_eq!(folder.rtf(&["show", "latest"]).code, Some(129), "the same");
}
