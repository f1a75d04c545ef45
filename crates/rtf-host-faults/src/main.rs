//! `rtf-host-faults`, see the library.
//!
//! The program starts as a C program does, without Rust's start-up code, as the other hosts.
#![no_main]
#![expect(unsafe_code, reason = "the program's entry point is C's")]

use std::ffi::{c_char, c_int};

#[unsafe(no_mangle)]
extern "C" fn main(argc: c_int, argv: *const *const c_char) -> c_int {
    // SAFETY: these are the system's arguments of `main`.
    unsafe { rtf_host_faults::PROGRAM.main(argc, argv) }
}
