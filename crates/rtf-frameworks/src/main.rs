//! The host of tests that were written for other frameworks: `rtf-host-framework TYPE`.
//!
//! A [`framework::Framework`] adapts one framework: it lists the cases of a program, starts
//! the program for some of them, and reads its report. The [`supervisor`] does everything
//! that all frameworks have in common: it runs the remaining cases after a crash, keeps the
//! limits, and compares the selected cases with the reported ones. `spec/frameworks.md`
//! documents both.
//!
//! The program starts as a C program does, without Rust's start-up code, as the other hosts.
#![no_main]
#![expect(unsafe_code, reason = "the program's entry point is C's")]

mod case_reporter;
mod check;
mod framework;
mod frameworks;
mod host;
mod listing;
mod supervisor;

use std::ffi::{CStr, OsString, c_char, c_int};
use std::os::unix::ffi::OsStrExt as _;

use rtf_host::Session;

/// The exit code after an error of the host itself.
const EXIT_ERROR: c_int = 2;

/// The entry point.
#[unsafe(no_mangle)]
extern "C" fn main(argc: c_int, argv: *const *const c_char) -> c_int {
    let count = usize::try_from(argc).unwrap_or_default();
    let args = (1..count).map(|index| {
        // SAFETY: the system passes `argc` strings.
        let arg = unsafe { CStr::from_ptr(*argv.add(index)) };
        std::ffi::OsStr::from_bytes(arg.to_bytes()).to_owned()
    });
    match run(args.collect()) {
        Ok(()) => 0,
        Err(error) => {
            eprintln!("error: {error}");
            EXIT_ERROR
        }
    }
}

fn run(args: Vec<OsString>) -> Result<(), Box<dyn std::error::Error>> {
    let Some((name, rest)) = args.split_first() else {
        return Err(frameworks::usage().into());
    };
    let Some((name, framework)) = frameworks::by_name(&name.to_string_lossy()) else {
        return Err(frameworks::usage().into());
    };
    if rest.first().is_some_and(|arg| arg == "--check") {
        return Ok(check::check(&*framework, &rest[1..])?);
    }
    let session = Session::open()?;
    let host = host::FrameworkHost::new(name, framework, session.clone())?;
    Ok(rtf_host::serve(&session, host)?)
}
