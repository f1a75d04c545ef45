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

use std::ffi::{c_char, c_int};

use rtf_host::{Host, Session, serve};

const HOST: Host<()> =
    Host { check: library::check, prepare: plugin::prepare, serve: serve_plugins };

/// The entry point.
#[unsafe(no_mangle)]
extern "C" fn main(argc: c_int, argv: *const *const c_char) -> c_int {
    // SAFETY: what the system calls this with.
    unsafe { HOST.main(argc, argv) }
}

fn serve_plugins(session: &Session, (): ()) -> std::io::Result<()> {
    serve(session, plugin::NativeHost::new(session.clone()))
}
