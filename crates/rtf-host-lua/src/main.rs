//! The host of Lua plug-ins: an embedded Lua 5.4 that exports Lua's symbols,
//! so that C modules load, and the table `rtf` of `sdk/lua`.
//!
//! It speaks the protocol through `rtf-host`; what is here is Lua's part:
//! finding modules ([`search`]), loading and calling a plug-in ([`host`]),
//! what a plug-in may call ([`sdk`]), and reaching code that hangs ([`watch`]).
//!
//! The program starts as a C program does, without Rust's start-up code: its
//! signal handler would swallow a `SIGSEGV` that a plug-in sends or raises.
#![no_main]
#![expect(unsafe_code, reason = "the program's entry point is C's")]

mod check;
mod host;
mod sdk;
mod search;
mod source;
mod watch;

use std::error::Error;
use std::ffi::{CStr, OsStr, OsString, c_char, c_int};
use std::io::Write;
use std::os::unix::ffi::OsStrExt;

use rtf_host::{Session, files_to_check, serve};

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
    match run(args.collect()) {
        Ok(()) => 0,
        Err(error) => {
            say(&*error);
            BROKEN
        }
    }
}

fn run(args: Vec<OsString>) -> Result<(), Box<dyn Error>> {
    if let Some(files) = files_to_check(args.iter().cloned()) {
        return Ok(rtf_host::check(&files, check::check)?);
    }
    if let Some(arg) = args.first() {
        let arg = arg.to_string_lossy();
        return Err(format!("unexpected argument `{arg}`; only `--check FILE…` is known").into());
    }
    let session = Session::open()?;
    watch::start(&session)?;
    Ok(serve(&session, host::LuaHost::new(session.clone()))?)
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
