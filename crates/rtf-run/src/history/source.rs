//! The history as the web server reads it.

use jiff::Timestamp;
use rtf_history::{Location, Store, StoreError, TestAttributes};
use rtf_web::{HistorySource, TestCondition};

use super::TestFilter;
use super::time::find_since;

/// The database of the web server.
#[derive(Debug)]
pub struct ServedHistory {
    /// The database, which may not exist.
    pub database: Location,
}

impl HistorySource for ServedHistory {
    fn open(&self) -> Result<Store, StoreError> {
        Store::open_existing(self.database.clone())
    }

    fn parse_filter(&self, text: &str) -> Result<TestCondition, String> {
        let filter = TestFilter::parse_one(text)?;
        Ok(Box::new(move |test: &TestAttributes| filter.matches(test)))
    }

    fn parse_since(&self, text: &str) -> Result<Timestamp, String> {
        let expected = "expected a date or a time span, like `2026-11-01` or `30d`";
        find_since(text).ok_or_else(|| format!("`{text}` is invalid, {expected}"))
    }
}
