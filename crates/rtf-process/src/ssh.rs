//! Processes on a remote machine: `ssh` starts a shell there, which runs the command and
//! stops it when the connection ends.
//!
//! The channel is the standard input of `ssh`, and so of the remote shell. The command
//! may run as long as the runner, or after its death the guard, holds the channel.

use std::sync::LazyLock;

use std::time::Duration;

use rtf_model::signal_name;

use crate::tree::SignalReach;

/// The remote script, without its comments.
static SCRIPT: LazyLock<String> = LazyLock::new(|| {
    let lines = include_str!("ssh.sh").lines().map(str::trim);
    let lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.collect::<Vec<_>>().join("\n")
});

/// The beginning of the remote command line.
static START: LazyLock<String> =
    LazyLock::new(|| format!("exec {}", shell_words::join(["sh", "-c", &SCRIPT, "rtf"])));

/// No prompts, a lost connection is noticed within 15 seconds, and the connection is not
/// shared.
const OPTIONS: [&str; 5] = [
    "BatchMode=yes",
    "ServerAliveInterval=5",
    "ServerAliveCountMax=3",
    "ControlMaster=no",
    "ControlPath=none",
];

/// A command for a remote machine.
#[derive(Clone, Copy, Debug)]
pub struct RemoteCommand<'a> {
    /// The machine, as `ssh` takes it.
    pub host: &'a str,
    /// The local `ssh` command with the user's options.
    pub ssh: &'a [String],
    /// The remote program and its arguments.
    pub command: &'a [String],
    /// The signal that stops it when the connection ends.
    pub stop_signal: i32,
    /// The time between that signal and the kill.
    pub stop_grace: Duration,
}

/// Returns the `ssh` command that runs a remote command with these variables. Its process
/// needs a channel.
pub fn command(remote: RemoteCommand<'_>, env: &[(String, String)]) -> Vec<String> {
    let mut command = remote.ssh.to_vec();
    for option in OPTIONS {
        command.extend(["-o".to_owned(), option.to_owned()]);
    }
    let grace = remote.stop_grace.as_secs_f64().ceil().to_string();
    let stop = [portable_name(remote.stop_signal), grace].into_iter();
    let variables = env.iter().map(|(name, value)| format!("{name}={value}"));
    let words: Vec<String> = stop.chain(variables).chain(remote.command.iter().cloned()).collect();
    let line = format!("{} {}", *START, shell_words::join(words));
    command.extend(["-T".to_owned(), "--".to_owned(), remote.host.to_owned(), line]);
    command
}

/// Whether a command is one of [`command`].
pub fn is_remote(command: &[String]) -> bool {
    command.last().is_some_and(|line| line.starts_with(START.as_str()))
}

/// Returns the line that sends a signal to a remote process over its channel.
pub fn signal_line(signal: i32, reach: SignalReach) -> Vec<u8> {
    let reach = if reach == SignalReach::Group { "" } else { " tree" };
    format!("{}{reach}\n", portable_name(signal)).into_bytes()
}

/// The signal's name without `SIG`: numbers differ between systems.
fn portable_name(signal: i32) -> String {
    let name = signal_name(signal).and_then(|name| name.strip_prefix("SIG"));
    name.map_or_else(|| signal.to_string(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead as _, BufReader, Read as _, Write as _};
    use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

    use super::*;

    fn ssh(words: &[&str], env: &[(String, String)]) -> Vec<String> {
        let words: Vec<_> = words.iter().map(|word| (*word).to_owned()).collect();
        let remote = RemoteCommand {
            host: "me@robot",
            ssh: &["ssh".to_owned()],
            command: &words,
            // Not SIGINT, which background jobs of a shell ignore.
            stop_signal: 15,
            stop_grace: Duration::from_millis(1200),
        };
        command(remote, env)
    }

    #[test]
    fn the_command_names_the_machine_after_all_options() {
        let command = ssh(&["driver"], &[]);
        assert!(is_remote(&command));
        assert!(!is_remote(&["sleep".to_owned(), "1".to_owned()]));
        let before = command.len() - 2;
        assert_eq!(command[before - 1..=before], ["--", "me@robot"]);
        assert!(command[before + 1].ends_with(" rtf TERM 2 driver"), "{}", command[before + 1]);
        assert_eq!(signal_line(2, SignalReach::Group), b"INT\n");
        assert_eq!(signal_line(28, SignalReach::Tree), b"28 tree\n");
    }

    /// Runs the line in a login shell and a new session, as `sshd` does.
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

    /// Returns the exit code and the output of a command.
    fn run(words: &[&str], env: &[(String, String)]) -> (Option<i32>, String) {
        let command = ssh(words, env);
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
    fn the_exit_code_of_ssh_itself_is_replaced() {
        assert_eq!(run(&["sh", "-c", "exit 255"], &[]).0, Some(254));
    }

    #[test]
    fn a_signal_line_reaches_the_command() {
        let script = "trap 'echo asked; exit 7' TERM; echo up; while :; do sleep 0.01; done";
        let command = ssh(&["sh", "-c", script], &[]);
        let (mut shell, mut life, mut printed) = start(command.last().unwrap());
        let mut line = String::new();
        printed.read_line(&mut line).unwrap();
        life.write_all(&signal_line(15, SignalReach::Group)).unwrap();
        printed.read_line(&mut line).unwrap();
        assert_eq!((line.as_str(), shell.wait().unwrap().code()), ("up\nasked\n", Some(7)));
    }

    /// In its group, and in another session.
    #[test]
    fn processes_that_outlive_the_command_have_the_grace() {
        for arm in ["sh -c", "setsid sh -c"] {
            let park = "trap 'sleep 0.2; echo parked; exit' TERM; echo up; \
                while :; do sleep 0.01; done";
            let script = format!("{arm} {} & wait", shell_words::quote(park));
            let command = ssh(&["sh", "-c", &script], &[]);
            let (mut shell, mut life, mut printed) = start(command.last().unwrap());
            let mut text = String::new();
            printed.read_line(&mut text).unwrap();
            life.write_all(&signal_line(15, SignalReach::Group)).unwrap();
            printed.read_to_string(&mut text).unwrap();
            assert_eq!((text.as_str(), shell.wait().unwrap().code()), ("up\nparked\n", Some(143)));
        }
    }

    #[test]
    fn the_end_of_its_channel_stops_it_and_processes_that_left_its_group() {
        let script = "setsid sleep 1000 & echo up; exec sleep 1000";
        let command = ssh(&["sh", "-c", script], &[]);
        let (mut shell, life, mut printed) = start(command.last().unwrap());
        let mut text = String::new();
        printed.read_line(&mut text).unwrap();
        drop(life);
        // Both keep it open while they are alive.
        printed.read_to_string(&mut text).unwrap();
        assert_eq!((text.as_str(), shell.wait().unwrap().code()), ("up\n", Some(143)));
    }
}
