//! The host of Lua plug-ins: an embedded Lua 5.4 that exports Lua's symbols,
//! so that C modules load, and the table `rtf` of `sdk/lua`.
//!
//! `rtf-host` implements the protocol. This program adds a Lua state with the SDK
//! ([`state`]), Lua's search paths ([`search_path`]), loading and calling a plug-in
//! ([`host`]), the functions of the SDK ([`sdk`], with code in Lua: [`chunk`]), and the
//! interruption of code that hangs ([`interruption`]).
//!
//! The program starts as a C program does, without Rust's start-up code: its
//! signal handler would swallow a `SIGSEGV` that a plug-in sends or raises.
#![no_main]
#![expect(unsafe_code, reason = "the program's entry point is C's")]

mod arguments;
mod cases;
mod check;
mod chunk;
mod clock;
mod faults;
mod fixture_values;
mod host;
mod interruption;
mod sdk;
mod search_path;
mod session_function;
mod source;
mod state;

use std::ffi::{c_char, c_int};

use rtf_host::{HostProgram, Session, serve};

use crate::state::PluginState;

const HOST: HostProgram<Option<PluginState>> =
    HostProgram { check: check::check, prepare, serve: serve_plugins };

#[unsafe(no_mangle)]
extern "C" fn main(argc: c_int, argv: *const *const c_char) -> c_int {
    // SAFETY: these are the system's arguments of `main`.
    unsafe { HOST.main(argc, argv) }
}

/// Prepares a state for the forks. `load` reports an error.
fn prepare() -> Option<PluginState> {
    // The first one compiles the SDK, and would leave garbage that forks copy.
    drop(PluginState::new());
    PluginState::new().ok()
}

fn serve_plugins(session: &Session, ready: Option<PluginState>) -> std::io::Result<()> {
    interruption::start(session);
    serve(session, host::LuaHost::new(session.clone(), ready))
}
