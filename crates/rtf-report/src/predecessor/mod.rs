//! What the runner of robot-testing-framework 2.x printed and wrote, for the
//! scripts that read it. `spec/testrunner.md` is the contract.
//!
//! [`lines`] turns an event into lines, [`ResultList`] shows some of them as they
//! come, [`file()`] writes all of them to a file at the end of the run, and [`write_junit`]
//! writes those of each test into its JUnit test case.

mod console;
mod file;
mod junit;
mod lines;
mod problems;
mod result_line;
mod summary;

pub use console::{ResultList, ResultListOptions};
pub use file::{file, write};
pub use junit::write_junit;
