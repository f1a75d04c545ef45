//! What the API answers: views of a record, made to be written as JSON.

mod case;
mod detail;
mod fixture;
mod hook;
mod info;
pub mod model;
mod question;
mod signal;
mod significance;
mod suite;
mod test;

pub use case::{Case, CaseCounts, Cases};
pub use detail::{
    Attached, Attachments, Measured, Measurements, Messages, OutputPage, Printed, Said, Stack,
    Stacks,
};
pub use fixture::{Fixture, Fixtures};
pub use hook::{Hook, Hooks};
pub use info::{RunInfo, RunList, Totals};
pub use question::{Asked, Questions};
pub use signal::{Signal, SignalList, Signals};
pub use significance::Significance;
pub use suite::{Snapshot, Suite, Suites};
pub use test::{Test, TestDetail, TestPage, TestState};

/// For serde: a value that is left out.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
