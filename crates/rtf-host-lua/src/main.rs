//! The host of Lua plug-ins: an embedded Lua 5.4 that exports Lua's symbols,
//! so that C modules load, and the table `rtf` of `sdk/lua`.
//!
//! It speaks the protocol through `rtf-host`; what is here is Lua's part:
//! a state with the SDK ([`state`]), finding modules ([`search`]), loading and calling a plug-in ([`host`]),
//! what a plug-in may call ([`sdk`], of parts in Lua: [`part`]), and reaching code that hangs ([`watch`]).
//!
//! The program starts as a C program does, without Rust's start-up code: its
//! signal handler would swallow a `SIGSEGV` that a plug-in sends or raises.
#![no_main]
#![expect(unsafe_code, reason = "the program's entry point is C's")]

mod check;
mod clock;
mod host;
mod part;
mod sdk;
mod search;
mod source;
mod state;
mod watch;

use std::ffi::{c_char, c_int};

use rtf_host::{Host, Session, serve};

use crate::state::State;

const HOST: Host<Option<State>> = Host { check: check::check, prepare, serve: serve_plugins };

/// The entry point.
#[unsafe(no_mangle)]
extern "C" fn main(argc: c_int, argv: *const *const c_char) -> c_int {
    // SAFETY: what the system calls this with.
    unsafe { HOST.main(argc, argv) }
}

/// What is wrong is told when there is a plug-in.
fn prepare() -> Option<State> {
    // The first one compiles the SDK. What that leaves in the memory, forks would copy.
    drop(State::new());
    State::new().ok()
}

fn serve_plugins(session: &Session, ready: Option<State>) -> std::io::Result<()> {
    watch::start(session);
    serve(session, host::LuaHost::new(session.clone(), ready))
}
