//! The host of the fixture `signals`: it records signals while tests run, and judges them by the
//! monitors of the suite. `spec/signals.md` specifies it.
//!
//! [`host`] implements the functions of a fixture. One thread ([`watch`]) reads the programs that
//! write samples ([`program`], [`mod@line`]), one for each measured fixture reads `/proc`
//! ([`processes`]), and one plays recordings ([`recording`]). All pass samples to the [`recorder`],
//! which knows the running tests ([`test_run`]) with their batches ([`batches`]) and monitors ([`judge`]).

mod batches;
mod command;
mod host;
mod judge;
mod line;
mod processes;
mod program;
mod recorder;
mod recording;
mod settings;
mod source_time;
mod test_run;
mod watch;

use rtf_host::{HostProgram, Session, added_fixture, serve};

pub const PROGRAM: HostProgram<()> =
    HostProgram { check: added_fixture::check, prepare: || (), serve: serve_signals };

fn serve_signals(session: &Session, (): ()) -> std::io::Result<()> {
    serve(session, host::SignalsHost::new(session.clone()))
}
