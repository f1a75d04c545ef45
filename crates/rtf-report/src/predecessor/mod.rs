//! What the runner of robot-testing-framework 2.x printed and wrote, for the
//! scripts that read it. `spec/testrunner.md` is the contract.
//!
//! [`lines`] turns an event into lines, [`ResultList`] shows some of them as they
//! come, [`file()`] writes all of them to a file at the end of the run.

mod console;
mod file;
mod lines;
mod problems;
mod result_line;
mod summary;

pub use console::{ResultList, ResultListOptions};
pub use file::{file, write};
