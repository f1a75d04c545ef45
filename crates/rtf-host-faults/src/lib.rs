//! The host of the fixture `faults`: it injects faults while tests run, and removes them.
//! `spec/faults.md` specifies it.
//!
//! [`host`] implements the functions of a fixture. The [`injector`] knows the running tests and
//! the faults that last. Its [`scheduler`] thread injects the faults whose time has come and
//! removes those whose time has elapsed; [`requests`] does what tests ask for. A fault is a [`lasting`]
//! effect: [`pauses`] of processes that [`targets`] finds, filled memory or disks ([`fill`]), or an
//! [`impairment`] or [`refusal`] of the packets of the private [`network`], which come over the
//! [`loopback`], or changes that a [`proxy`] makes.
//!
//! Memory and files without a name belong to this process, so the kernel frees them when it ends.

mod clock;
mod fill;
mod host;
mod impairment;
mod injector;
mod lasting;
mod loopback;
mod network;
mod pauses;
mod proxy;
mod refusal;
mod requests;
mod running_test;
mod scheduler;
mod settings;
mod targets;
mod unix;

use rtf_host::{HostProgram, Session, added_fixture, serve};

pub const PROGRAM: HostProgram<()> =
    HostProgram { check: added_fixture::check, prepare: || (), serve: serve_faults };

fn serve_faults(session: &Session, (): ()) -> std::io::Result<()> {
    serve(session, host::FaultsHost::new(session.clone()))
}
