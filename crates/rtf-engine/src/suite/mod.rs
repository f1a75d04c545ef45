//! Suite files: text → [`Suite`], what was written.
//!
//! Responsible for XML, for which elements and attributes there are, and for
//! the form of their values, each with its place in the file. Every problem of
//! a file is reported, not only the first one. Not responsible for whether a
//! plug-in, a program or a host exists: that is [`crate::plan`].
//!
//! `spec/suite.md` is the text for people, `spec/suite.xsd` the schema.

mod clock;
mod command;
mod duration;
mod env;
mod fixture;
mod hook;
mod middleware;
mod open;
mod param;
mod places;
pub(crate) mod port;
mod prepass;
mod probe;
mod process;
mod read;
mod requires;
mod shape;
mod signal;
mod source;
mod test;
mod types;
mod value;
mod xml;

pub use duration::{DurationError, parse_duration};
pub(crate) use env::is_reserved;
pub use open::{MAX_SUITE_BYTES, Unreadable, is_suite_file, open};
pub use param::split_param;
pub use places::places;
pub use read::load;
pub(crate) use shape::nearest;
pub use signal::signal_name;
pub use source::{Source, Sources, Span, Spanned};
pub use types::*;
