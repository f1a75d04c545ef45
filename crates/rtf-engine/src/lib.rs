//! Runs plans.
//!
//! [`verify`] checks whether the plug-ins of a plan can be loaded. [`run`] runs
//! the plan: a state machine without I/O or clock, with one task around it.
//! [`isolate`] gives a suite its private network, ports and ids; [`guard`] takes over
//! when the runner dies.

pub mod guard;
pub mod isolate;
pub mod locks;
pub mod run;
pub mod signal;
pub mod verify;
