//! Loads suites, plans runs, and runs them.
//!
//! [`suite`] turns text into what was written, [`plan`] turns that into what
//! will be done and finds every problem before a process starts, and [`run`]
//! does it: a state machine without I/O or clock, with one task around it.
//! [`host`] is how processes are started, spoken to, and ended; [`isolate`] is
//! what a suite gets for itself; [`guard`] is who does what is left to do when
//! the runner dies.

pub mod config;
pub mod guard;
pub mod host;
pub mod isolate;
pub mod locks;
pub mod plan;
pub mod run;
pub mod select;
pub mod signal;
pub mod suite;
