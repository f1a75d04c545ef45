//! Parsers of option values, with better error messages than clap's.

use std::env::var_os;
use std::ffi::OsStr;
use std::num::NonZeroU16;

use clap::builder::{PossibleValuesParser, Resettable, TypedValueParser};
use clap::{Arg, Command};
use rtf_process::fork_server::ForkMode;

/// Treats an empty environment variable as not set.
pub fn unset_when_empty(command: Command) -> Command {
    let is_empty = |name: &OsStr| var_os(name).is_some_and(|value| value.is_empty());
    let clear = |arg: Arg| match arg.get_env().is_some_and(is_empty) {
        true => arg.env(Resettable::Reset),
        false => arg,
    };
    command.mut_args(clear).mut_subcommands(unset_when_empty)
}

/// Reports the range for a zero, unlike clap's parser of `NonZeroU16`.
pub fn jobs_parser() -> impl TypedValueParser<Value = NonZeroU16> {
    clap::value_parser!(u16).range(1..).try_map(NonZeroU16::try_from)
}

pub fn fork_mode_parser() -> impl TypedValueParser<Value = ForkMode> {
    PossibleValuesParser::new(["auto", "always", "never"]).map(|name| parse_fork_mode(&name))
}

/// Parses `auto`, `always` or `never`.
pub fn parse_fork_mode(word: &str) -> ForkMode {
    match word {
        "always" => ForkMode::Always,
        "never" => ForkMode::Never,
        _ => ForkMode::Auto,
    }
}

/// Parses the seed of a random order.
///
/// # Errors
/// It is not a number.
pub fn parse_seed(value: &str) -> Result<u64, String> {
    value.parse().map_err(|_| "expected a number, as printed by an earlier run".to_owned())
}

/// Parses `tolerance=0.02`.
///
/// # Errors
/// There is no `=`, or the name is invalid.
pub fn parse_setting(value: &str) -> Result<(String, String), String> {
    match value.split_once('=') {
        Some((name, value)) if rtf_plan::config::is_name(name) => {
            Ok((name.to_owned(), value.to_owned()))
        }
        Some((name, _)) => Err(format!("`{name}` is not the name of a parameter")),
        None => Err("expected `NAME=VALUE`".to_owned()),
    }
}
