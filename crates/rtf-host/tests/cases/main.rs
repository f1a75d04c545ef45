//! Cases and skips as the host reports them, driven over a socket pair.
#![expect(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod episode_errors;
mod episodes;
mod reporting;
mod script_host;
mod selection;
mod skips;
mod threads;
