//! The command of a program that writes samples.

use std::process::{Command, Stdio};

/// The command with these words; what it prints can be read.
///
/// # Errors
/// There are no words.
pub(crate) fn of(words: &[String]) -> Result<Command, String> {
    let (program, args) = words.split_first().ok_or("there is no program")?;
    let mut command = Command::new(program);
    command.args(args).stdin(Stdio::null()).stdout(Stdio::piped());
    Ok(command)
}

/// The words of a command, for messages.
pub(crate) fn shown(words: &[String]) -> String {
    format!("`{}`", words.join(" "))
}
