//! `rtf.toml`: what holds for all suites below a folder, and what other
//! profiles (the real robot, a simulator, CI) change of it.
//!
//! Responsible for finding the file, for reading it with the place of each
//! value, and for laying its values over a [`crate::suite::Suite`]. What
//! concerns a run as a whole ([`Run`]) is only told to whoever asks.
//! `spec/config.md` is the text for people; why the order of precedence is as
//! it is: `docs/decisions/0015-precedence-of-settings.md`.

mod file;
mod keys;
mod lay;
mod param;
mod read;
mod run;
mod show;
mod view;

pub use file::{ConfigFile, Files};
pub use keys::REPORTS;
pub use read::{Entry, Layer};
pub use run::{Run, RunValue, folder_of_input};
pub use show::{OfSuite, Question, Shown, show};
pub use view::{Asked, View};

pub(crate) use lay::{Singles, lay, of_singles};
pub use param::is_name;
pub(crate) use param::sample;
