//! The host of C and C++ plug-ins: loads a shared library, calls it through
//! the interface of `spec/plugin-abi.md`, and speaks the host protocol.
//!
//! The program starts as a C program does, without Rust's start-up code: that
//! would leave signal handlers and a second signal stack in a process that
//! belongs to the plug-in. It ends through the C library's `exit`, so that
//! static destructors, coverage and sanitizers do their work. A plug-in is
//! never unloaded.
#![no_main]
#![expect(unsafe_code, reason = "the program's entry point is C's")]

mod abi;
mod host_table;
mod library;
mod plugin;

use std::error::Error;
use std::ffi::{CStr, OsStr, OsString, c_char, c_int};
use std::io::Write;
use std::os::unix::ffi::OsStrExt;

use rtf_host::{Session, check, files_to_check, serve};

/// The exit code of a host that could not do its work.
const BROKEN: c_int = 2;

/// The entry point.
#[unsafe(no_mangle)]
extern "C" fn main(argc: c_int, argv: *const *const c_char) -> c_int {
    let count = usize::try_from(argc).unwrap_or(0);
    let args = (1..count).map(|index| {
        // SAFETY: the system passes `argc` strings.
        let arg = unsafe { CStr::from_ptr(*argv.add(index)) };
        OsStr::from_bytes(arg.to_bytes()).to_owned()
    });
    match host(args.collect()) {
        Ok(()) => 0,
        Err(error) => {
            say(&*error);
            BROKEN
        }
    }
}

fn host(args: Vec<OsString>) -> Result<(), Box<dyn Error>> {
    if let Some(files) = files_to_check(args.iter().cloned()) {
        return Ok(check(&files, library::check)?);
    }
    if let Some(arg) = args.first() {
        let arg = arg.to_string_lossy();
        return Err(format!("unexpected argument `{arg}`; only `--check FILE…` is known").into());
    }
    let session = Session::open()?;
    let host = plugin::NativeHost::new(session.clone());
    Ok(serve(&session, host)?)
}

/// Prints the error with its causes. The runner shows it as the host's output.
fn say(error: &dyn Error) {
    let mut text = format!("error: {error}\n");
    let mut cause = error.source();
    while let Some(error) = cause {
        text.push_str(&format!("caused by: {error}\n"));
        cause = error.source();
    }
    // When even this cannot be written, the exit code is left.
    drop(std::io::stderr().write_all(text.as_bytes()));
}
