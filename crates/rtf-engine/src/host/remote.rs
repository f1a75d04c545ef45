//! Process fixtures on another machine: they run below a shell that `ssh` starts
//! there and that stops them when the connection is gone.
//!
//! The channel is the standard input of `ssh`, and so of that shell: as long as
//! the runner, or after its death the guard, holds it, the fixture may run.

use std::sync::LazyLock;

use rtf_plan::plan::{ProcessPlan, RemotePlan};
use rtf_plan::suite::signal_name;

/// What runs on the other machine, without its comments.
static SCRIPT: LazyLock<String> = LazyLock::new(|| {
    let lines = include_str!("remote.sh").lines().map(str::trim);
    let lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.collect::<Vec<_>>().join("\n")
});

/// How the line for the other machine begins.
static START: LazyLock<String> =
    LazyLock::new(|| format!("exec {}", shell_words::join(["sh", "-c", &SCRIPT, "rtf"])));

/// No question is asked that nobody could answer, a connection that is gone is
/// noticed within 15 seconds, and it is no other's connection.
const OPTIONS: [&str; 5] = [
    "BatchMode=yes",
    "ServerAliveInterval=5",
    "ServerAliveCountMax=3",
    "ControlMaster=no",
    "ControlPath=none",
];

/// The `ssh` command that runs a fixture on its machine with these variables.
/// Its process needs a channel.
#[must_use]
pub fn command(
    process: &ProcessPlan,
    remote: &RemotePlan,
    env: &[(String, String)],
) -> Vec<String> {
    let mut command = remote.ssh.clone();
    for option in OPTIONS {
        command.extend(["-o".to_owned(), option.to_owned()]);
    }
    let grace = process.stop_grace.as_secs_f64().ceil().to_string();
    let stop = [name(process.stop_signal), grace].into_iter();
    let variables = env.iter().map(|(name, value)| format!("{name}={value}"));
    let words: Vec<String> = stop.chain(variables).chain(process.command.iter().cloned()).collect();
    let line = format!("{} {}", *START, shell_words::join(words));
    command.extend(["-T".to_owned(), "--".to_owned(), remote.host.clone(), line]);
    command
}

/// Whether a command is one of [`command`].
#[must_use]
pub fn is_remote(command: &[String]) -> bool {
    command.last().is_some_and(|line| line.starts_with(START.as_str()))
}

/// What is written to a fixture's channel to send it a signal.
#[must_use]
pub fn signal_line(signal: i32) -> Vec<u8> {
    format!("{}\n", name(signal)).into_bytes()
}

/// The other machine may have other numbers.
fn name(signal: i32) -> String {
    signal_name(signal).map_or_else(|| signal.to_string(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead as _, BufReader, Read as _, Write as _};
    use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
    use std::time::Duration;

    use super::*;

    fn process(command: &[&str]) -> ProcessPlan {
        ProcessPlan {
            command: command.iter().map(|word| (*word).to_owned()).collect(),
            ready: Vec::new(),
            alive: Vec::new(),
            // Not SIGINT, which a shell lets its background jobs ignore.
            stop_signal: 15,
            stop_grace: Duration::from_millis(1200),
            stop_codes: Vec::new(),
            remote: None,
        }
    }

    fn remote() -> RemotePlan {
        RemotePlan { host: "me@robot".to_owned(), ssh: vec!["ssh".to_owned()] }
    }

    #[test]
    fn the_command_names_the_machine_after_all_options() {
        let command = command(&process(&["driver"]), &remote(), &[]);
        assert!(is_remote(&command));
        assert!(!is_remote(&["sleep".to_owned(), "1".to_owned()]));
        let before = command.len() - 2;
        assert_eq!(command[before - 1..=before], ["--", "me@robot"]);
        assert!(command[before + 1].ends_with(" rtf TERM 2 driver"), "{}", command[before + 1]);
        assert_eq!(signal_line(2), b"INT\n");
        assert_eq!(signal_line(28), b"28\n");
    }

    /// The line goes through a login shell, as with `sshd`, into a session of its own.
    fn start(line: &str) -> (Child, ChildStdin, BufReader<ChildStdout>) {
        let mut shell = Command::new("setsid")
            .args(["--wait", "sh", "-c", line])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut life = shell.stdin.take().unwrap();
        life.write_all(b"hello\n").unwrap();
        let printed = BufReader::new(shell.stdout.take().unwrap());
        (shell, life, printed)
    }

    /// What a command ends with, and prints.
    fn run(words: &[&str], env: &[(String, String)]) -> (Option<i32>, String) {
        let command = command(&process(words), &remote(), env);
        let (mut shell, _life, mut printed) = start(command.last().unwrap());
        let mut text = String::new();
        printed.read_to_string(&mut text).unwrap();
        (shell.wait().unwrap().code(), text)
    }

    #[test]
    fn words_and_variables_arrive_as_they_are() {
        let odd = "a 'b' \"c\" $HOME `d` \\ !e\n*";
        let words = ["sh", "-c", "printf '%s|' \"$@\" \"$V\"; exit 3", "sh", odd, ""];
        let env = [("V".to_owned(), odd.to_owned())];
        assert_eq!(run(&words, &env), (Some(3), format!("{odd}||{odd}|")));
    }

    #[test]
    fn a_code_that_is_the_word_of_ssh_itself_is_another_one() {
        assert_eq!(run(&["sh", "-c", "exit 255"], &[]).0, Some(254));
    }

    #[test]
    fn a_signal_line_reaches_the_command() {
        let script = "trap 'echo asked; exit 7' TERM; echo up; while :; do sleep 0.01; done";
        let command = command(&process(&["sh", "-c", script]), &remote(), &[]);
        let (mut shell, mut life, mut printed) = start(command.last().unwrap());
        let mut line = String::new();
        printed.read_line(&mut line).unwrap();
        life.write_all(&signal_line(15)).unwrap();
        printed.read_line(&mut line).unwrap();
        assert_eq!((line.as_str(), shell.wait().unwrap().code()), ("up\nasked\n", Some(7)));
    }

    #[test]
    fn the_end_of_its_life_line_stops_it_and_what_left_its_group() {
        let script = "setsid sleep 1000 & echo up; exec sleep 1000";
        let command = command(&process(&["sh", "-c", script]), &remote(), &[]);
        let (mut shell, life, mut printed) = start(command.last().unwrap());
        let mut text = String::new();
        printed.read_line(&mut text).unwrap();
        drop(life);
        // Both have it open as long as they live.
        printed.read_to_string(&mut text).unwrap();
        assert_eq!((text.as_str(), shell.wait().unwrap().code()), ("up\n", Some(143)));
    }
}
