//! Paths → plan, in folders with hosts that are shell scripts.

mod bench;
mod inputs;
mod plugins;
mod suites;
mod verify;
