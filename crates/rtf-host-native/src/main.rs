//! The host of C and C++ plug-ins: loads a shared library and calls it through
//! the interface of `spec/plugin-abi.md`.
//!
//! The program starts as a C program does, without Rust's start-up code: that
//! would leave signal handlers and a second signal stack in a process that
//! belongs to the plug-in. It ends with the C library's `exit`, so that static
//! destructors, coverage tools and sanitizers work. It never unloads a plug-in.
#![no_main]
#![expect(unsafe_code, reason = "the program's entry point is C's")]

mod abi;
mod conversion;
mod host_table;
mod library;
mod plugin;

use std::ffi::{c_char, c_int};

use rtf_host::{HostProgram, Session, serve};

const HOST: HostProgram<()> =
    HostProgram { check: library::check, prepare: plugin::prepare, serve: serve_plugins };

/// The entry point.
#[unsafe(no_mangle)]
extern "C" fn main(argc: c_int, argv: *const *const c_char) -> c_int {
    // SAFETY: these are the system's arguments of `main`.
    unsafe { HOST.main(argc, argv) }
}

fn serve_plugins(session: &Session, (): ()) -> std::io::Result<()> {
    serve(session, plugin::NativeHost::new(session.clone()))
}
