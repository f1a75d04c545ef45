//! A private network namespace, and the process that holds it.

mod client;
mod holder;
mod unix;

pub use client::{HeldNetwork, Network, NetworkError, connect};
pub use holder::{HOLD_ARGUMENT, hold};
