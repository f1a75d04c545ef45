//! `rtf-host-framework TYPE`, see the library.
//!
//! The program starts as a C program does, without Rust's start-up code, as the other hosts.
#![no_main]
#![expect(unsafe_code, reason = "the program's entry point is C's")]

use std::ffi::{CStr, c_char, c_int};
use std::io::Write as _;
use std::os::unix::ffi::OsStrExt as _;

/// The exit code after an error of the host itself.
const EXIT_ERROR: c_int = 2;

#[unsafe(no_mangle)]
extern "C" fn main(argc: c_int, argv: *const *const c_char) -> c_int {
    let count = usize::try_from(argc).unwrap_or_default();
    let args = (1..count).map(|index| {
        // SAFETY: the system passes `argc` strings.
        let arg = unsafe { CStr::from_ptr(*argv.add(index)) };
        std::ffi::OsStr::from_bytes(arg.to_bytes()).to_owned()
    });
    match rtf_frameworks::run(args.collect()) {
        Ok(()) => 0,
        Err(error) => {
            drop(writeln!(std::io::stderr(), "error: {error}"));
            EXIT_ERROR
        }
    }
}
