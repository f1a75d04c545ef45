//! How options' values are read, where clap alone does not tell what is wrong.

use std::env::var_os;
use std::ffi::OsStr;
use std::num::NonZeroU16;

use clap::builder::{PossibleValuesParser, Resettable, TypedValueParser};
use clap::{Arg, Command};
use rtf_process::fork_server::ForkMode;

/// A variable that is set to nothing is one that is not set.
pub fn unset_when_empty(command: Command) -> Command {
    let is_empty = |name: &OsStr| var_os(name).is_some_and(|value| value.is_empty());
    let clear = |arg: Arg| match arg.get_env().is_some_and(is_empty) {
        true => arg.env(Resettable::Reset),
        false => arg,
    };
    command.mut_args(clear).mut_subcommands(unset_when_empty)
}

/// Clap's words for a zero tell the range.
pub fn jobs_parser() -> impl TypedValueParser<Value = NonZeroU16> {
    clap::value_parser!(u16).range(1..).try_map(NonZeroU16::try_from)
}

pub fn forks_parser() -> impl TypedValueParser<Value = ForkMode> {
    PossibleValuesParser::new(["auto", "always", "never"]).map(|name| forks(&name))
}

/// `auto`, `always` or `never`.
pub fn forks(word: &str) -> ForkMode {
    match word {
        "always" => ForkMode::Always,
        "never" => ForkMode::Never,
        _ => ForkMode::Auto,
    }
}

/// Reads what decides a random order.
///
/// # Errors
/// It is no number.
pub fn parse_seed(value: &str) -> Result<u64, String> {
    value.parse().map_err(|_| "expected a number, as an earlier run shows it".to_owned())
}

/// Reads `tolerance=0.02`.
///
/// # Errors
/// What is wrong with it.
pub fn parse_setting(value: &str) -> Result<(String, String), String> {
    match value.split_once('=') {
        Some((name, value)) if rtf_plan::config::is_name(name) => {
            Ok((name.to_owned(), value.to_owned()))
        }
        Some((name, _)) => Err(format!("`{name}` is not the name of a parameter")),
        None => Err("expected `NAME=VALUE`".to_owned()),
    }
}
