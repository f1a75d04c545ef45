//! The host's side of the protocol, driven over a socket pair as the runner drives it.
#![expect(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod notifications;
mod requests;
mod script_host;
