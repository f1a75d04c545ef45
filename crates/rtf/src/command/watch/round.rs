//! A round: this program again, as `rtf run`.

use std::ffi::OsString;
use std::io;
use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;

use tokio::process::{Child, Command};

use crate::command::child;
use crate::exit;

/// Starts one, with the options of this process.
pub fn start() -> io::Result<Child> {
    let round = child::again(as_run(std::env::args_os().skip(1).collect()))?;
    Command::from(round).spawn()
}

/// What was typed, with the verb `run`; it ends with this process.
fn as_run(mut args: Vec<OsString>) -> Vec<OsString> {
    let mut at = 0;
    while let Some(arg) = args.get_mut(at) {
        if arg == "--color" {
            at += 1;
        } else if !arg.to_string_lossy().starts_with('-') {
            *arg = "run".into();
            if !args.contains(&child::OPTION.into()) {
                args.insert(at + 1, child::OPTION.into());
            }
            break;
        }
        at += 1;
    }
    args
}

/// The exit code, as a shell tells it.
pub fn code_of(status: ExitStatus) -> u8 {
    let code = status.code().or_else(|| status.signal().map(|signal| 128 + signal));
    code.and_then(|code| u8::try_from(code).ok()).unwrap_or(exit::BROKEN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_is_a_run_with_the_same_options() {
        let of = |text: &str| {
            let args = as_run(text.split(' ').map(OsString::from).collect());
            args.join(" ".as_ref()).into_string().unwrap_or_default()
        };
        assert_eq!(of("watch a.xml"), "run --end-with-stdin a.xml");
        assert_eq!(
            of("--color never watch -E all() watch"),
            "--color never run --end-with-stdin -E all() watch"
        );
        assert_eq!(of("--color=watch watch watch"), "--color=watch run --end-with-stdin watch");
    }
}
