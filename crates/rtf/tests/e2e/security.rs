//! What `SECURITY.md` promises about other users of the machine.

use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, symlink};
use std::path::Path;
use std::process::Command;

use crate::support::{Folder, root};

const SUITE: &str = "<suite requires='robot'>
  <fixture type='process'><command>sh -c 'echo up; exec sleep 1000'</command><ready log='up'/></fixture>
  <test>A.lua</test>
</suite>
";

const TEST: &str = "TestCase = {}
function TestCase.run()
  io.open('plot.txt', 'w'):write('1 2 3'):close()
  rtf.attach('plot.txt')
  print('printed')
end
";

/// A run with this umask.
fn command(folder: &Folder, umask: &str) -> Command {
    let run = folder.command(&["run", "s.xml", "--report", "junit=rtf-results/junit.xml"]);
    let mut command = Command::new("sh");
    command.args(["-c", &format!("umask {umask}; exec \"$@\""), "sh"]);
    command.arg(run.get_program()).args(run.get_args());
    for (name, value) in run.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    command.current_dir(run.get_current_dir().unwrap_or(root()));
    command.env("RTF_LOCKS", folder.path().join("locks"));
    command
}

/// All files and directories below a directory, with their permissions.
fn modes(dir: &Path, found: &mut Vec<(String, u32)>) {
    for entry in std::fs::read_dir(dir).expect("a directory").flatten() {
        let metadata = entry.metadata().expect("an entry");
        if metadata.is_symlink() {
            continue;
        }
        found.push((entry.path().display().to_string(), metadata.permissions().mode()));
        if metadata.is_dir() {
            modes(&entry.path(), found);
        }
    }
}

#[test]
fn results_have_the_umask_of_the_user() {
    let folder = Folder::new();
    folder.file("s.xml", SUITE).file("A.lua", TEST);
    for (umask, forbidden) in [("077", 0o077), ("027", 0o027)] {
        let run = command(&folder, umask).output().expect("rtf runs");
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stdout));
        let mut found = Vec::new();
        modes(&folder.path().join("rtf-results"), &mut found);
        for name in ["events.jsonl", "plot.txt", "junit.xml"] {
            assert!(found.iter().any(|(path, _)| path.ends_with(name)), "{name} in {found:?}");
        }
        for (path, mode) in &found {
            assert_eq!(mode & forbidden, 0, "{path} has the mode {mode:o} with umask {umask}");
        }
        std::fs::remove_dir_all(folder.path().join("rtf-results")).expect("results");
    }
}

#[test]
fn a_planted_link_in_the_directory_of_locks_changes_no_file() {
    let own = std::fs::metadata("/proc/self").expect("this process").uid();
    for planted in ["robot.1", &format!("robot.1.of-{own}")] {
        let folder = Folder::new();
        folder.file("s.xml", SUITE).file("A.lua", TEST).file("valuable", "contents");
        let locks = folder.path().join("locks");
        std::fs::create_dir(&locks).expect("a directory");
        symlink(folder.path().join("valuable"), locks.join(planted)).expect("a link");
        let run = command(&folder, "022").output().expect("rtf runs");
        // The lock itself cannot be taken; without a record of it, the lock still protects.
        assert_eq!(run.status.success(), planted != "robot.1", "{planted}: {run:?}");
        assert_eq!(folder.read("valuable"), "contents", "{planted}");
    }
}
