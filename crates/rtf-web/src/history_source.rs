//! Where the history is, and how its filters are written. The program that contains the
//! server implements it.

use jiff::Timestamp;
use rtf_history::{Store, StoreError, TestAttributes};

pub type TestCondition = Box<dyn Fn(&TestAttributes) -> bool + Send>;

/// The history that a server shows.
pub trait HistorySource: Send + Sync {
    /// Opens the database.
    ///
    /// # Errors
    /// It does not exist, or cannot be read.
    fn open(&self) -> Result<Store, StoreError>;

    /// Parses a filter, as on the command line.
    ///
    /// # Errors
    /// What is wrong with it.
    fn parse_filter(&self, text: &str) -> Result<TestCondition, String>;

    /// Parses a time: a date, or a time span before now.
    ///
    /// # Errors
    /// What is wrong with it.
    fn parse_since(&self, text: &str) -> Result<Timestamp, String>;
}
