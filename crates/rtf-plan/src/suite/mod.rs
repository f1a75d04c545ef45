//! Suite files: text → [`DeclaredSuite`].
//!
//! Responsible for the XML, for the known elements and attributes, and for the
//! format of their values, each with its position in the file. Reports every
//! problem of a file, not only the first one. Whether a plug-in, a program or a
//! host exists is checked by [`crate::plan`].
//!
//! `spec/suite.md` specifies the file, `spec/suite.xsd` is its schema.

mod clock;
mod command;
mod document;
mod duration;
mod env;
pub mod episode_reference;
mod episode_test;
mod fault;
mod fault_quantity;
mod fault_types;
mod fixture;
pub mod fixture_reference;
mod fixture_types;
mod hook;
mod hook_types;
mod known_failure;
mod learn;
pub mod matrix;
mod middleware;
mod monitor;
mod param_string;
pub mod port_reference;
mod prepass;
mod probe;
mod process;
mod provide;
mod reader;
mod reference;
mod requires;
mod reset;
mod root;
pub mod schema;
mod shared_settings;
mod signal;
mod signal_source;
mod signal_types;
mod source;
mod source_file;
mod test;
mod text_position;
mod types;
mod value_fault;
mod xml;

pub use document::read_document;
pub(crate) use duration::MAX_DURATION;
pub use duration::{DurationError, parse_duration};
pub(crate) use env::is_reserved;
pub use fault_types::*;
pub use fixture_reference::{FixtureReference, FixtureReferences, ReferenceUser};
pub use fixture_types::*;
pub use hook_types::*;
pub(crate) use known_failure::{parse_day, parse_verdict};
pub(crate) use matrix::invalid_value;
pub use matrix::{Combination, DeclaredMatrix, MatrixDimension, MatrixExclude};
pub use param_string::split_param;
pub use reader::ElementReader;
pub use root::parse;
pub use shared_settings::{SharedSettings, shared_settings};
pub use signal_types::*;
pub use source::{SourceMap, SourceText, Span, Spanned};
pub use source_file::{
    MAX_SUITE_BYTES, UnreadableFile, is_campaign_file, is_replay_suite, is_suite_file, read_source,
    replay_suite,
};
pub use text_position::position_of;
pub use types::*;
