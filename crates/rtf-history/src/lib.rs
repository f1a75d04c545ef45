//! Results over time: a store of the results of many runs, and questions to it.
//! `spec/history.md` is its specification.
//!
//! - [`entry`]: the record of a run → the rows to store. Pure.
//! - [`store`]: the database. All SQL is in [`store::schema`] and [`store::sql`].
//! - [`answers`]: runs, history of a test, flaky and slow tests, trends, comparisons. Typed
//!   values that serialise to the JSON of `rtf history`; this crate prints nothing.
//! - [`statistics`]: statistics of series. Pure.

pub mod answers;
pub mod entry;
mod identity;
mod selection;
pub mod statistics;
pub mod store;

pub use identity::{SuiteFileBase, TestIdentity};
pub use selection::{RunSelection, TestAttributes, TestSelection};
pub use store::{ImportOutcome, Location, Store, StoreError};

/// For serde, which calls it with a reference.
fn is_zero(number: &u64) -> bool {
    *number == 0
}
