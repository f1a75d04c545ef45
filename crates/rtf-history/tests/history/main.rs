//! The store and its answers, over runs that are made up.

#![expect(clippy::expect_used, reason = "a helper that cannot continue fails its test")]

mod answers;
mod bad_input;
mod campaigns;
mod columns;
mod gate;
mod importing;
mod learned;
mod pruning;
mod recent;
mod world;
