//! What happens with the results when a run has ended. Nothing here changes its exit code.

use rtf_model::Record;

use crate::collector::Collector;
use crate::history::{self, HistoryTarget};

/// Where the results go.
#[derive(Default)]
pub struct ResultTargets {
    /// Where the run is imported.
    pub history: Option<HistoryTarget>,
    /// Which collectors get its trace.
    pub collectors: Vec<Collector>,
}

impl ResultTargets {
    /// Imports and sends the results.
    pub fn finish(&self, record: &Record) {
        if let Some(history) = &self.history {
            history::import_run(history, record);
        }
        for collector in &self.collectors {
            collector.push(record);
        }
    }
}
