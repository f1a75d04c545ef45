//! When `rtf watch` runs the tests again: [`debounce`] decides when changes of files are due, and
//! [`state`] what to do.

pub mod debounce;
pub mod state;
