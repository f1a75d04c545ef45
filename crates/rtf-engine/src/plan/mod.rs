//! Suite + options → plan.

mod types;

pub use types::*;
