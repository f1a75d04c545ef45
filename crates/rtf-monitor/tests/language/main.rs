//! The language of formulas: what is accepted, what is rejected, and with which message.

#![expect(clippy::unwrap_used, reason = "that is where a test ends")]

mod syntax;
mod units;
