//! Starts a run: this program with the same options, as `rtf run`.
//!
//! The arguments are those that the user typed, not a request: each run reads `rtf.toml` and the
//! files that the arguments name as they are then.

use std::ffi::OsString;
use std::io;

use rtf_run::spawn_self;
use tokio::process::{Child, Command};

/// Starts a run, which ends with this process.
pub fn start() -> io::Result<Child> {
    let command = spawn_self::command(run_args(std::env::args_os().skip(1).collect()))?;
    Command::from(command).spawn()
}

/// Replaces the verb `watch` by `run`.
fn run_args(mut args: Vec<OsString>) -> Vec<OsString> {
    let mut index = 0;
    while let Some(arg) = args.get_mut(index) {
        if arg == "--color" {
            index += 1;
        } else if !arg.to_string_lossy().starts_with('-') {
            *arg = "run".into();
            if !args.contains(&spawn_self::END_WITH_STDIN.into()) {
                args.insert(index + 1, spawn_self::END_WITH_STDIN.into());
            }
            break;
        }
        index += 1;
    }
    args
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_run_has_the_same_options() {
        let run = |text: &str| {
            let args = run_args(text.split(' ').map(OsString::from).collect());
            args.join(" ".as_ref()).into_string().unwrap_or_default()
        };
        assert_eq!(run("watch a.xml"), "run --end-with-stdin a.xml");
        assert_eq!(
            run("--color never watch -E all() watch"),
            "--color never run --end-with-stdin -E all() watch"
        );
        assert_eq!(run("--color=watch watch watch"), "--color=watch run --end-with-stdin watch");
    }
}
