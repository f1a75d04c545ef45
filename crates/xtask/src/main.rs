//! Makes what is generated from the code and kept in the repository, or with
//! `--check` compares the kept files with what the code makes.
//!
//! ```text
//! cargo run -p xtask -- schemas [--check]    schemas/*.json, from rtf-model
//! cargo run -p xtask -- header [--check]     sdk/c/include/rtf/plugin.h
//! ```

mod header;
mod openapi;
mod schemas;

use std::error::Error;
use std::io::Write;
use std::process::ExitCode;

const USAGE: &str = "usage: cargo run -p xtask -- schemas|header [--check]";

fn main() -> ExitCode {
    let words: Vec<_> = std::env::args().skip(1).collect();
    let words: Vec<_> = words.iter().map(String::as_str).collect();
    let done: Result<(), Box<dyn Error>> = match words[..] {
        ["schemas"] => schemas::run(false).map_err(Box::from),
        ["schemas", "--check"] => schemas::run(true).map_err(Box::from),
        ["header"] => header::run(false).map_err(Box::from),
        ["header", "--check"] => header::run(true).map_err(Box::from),
        _ => Err(USAGE.into()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            tell(error.as_ref());
            ExitCode::FAILURE
        }
    }
}

fn tell(error: &dyn Error) {
    let mut err = std::io::stderr().lock();
    // Where standard error is closed, the exit code alone reports the problem.
    drop(writeln!(err, "error: {error}"));
    let mut cause = error.source();
    while let Some(error) = cause {
        drop(writeln!(err, "caused by: {error}"));
        cause = error.source();
    }
}
