//! The language of formulas: what is accepted, what is rejected, and with which message.

mod syntax;
mod units;
