//! The past results from which tests are ordered and assigned to shards.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use rtf_history::StoreError;
use rtf_model::{Diagnostic, Manifest, Record};
use rtf_plan::select::{PastResult, PastResults, Shard, ShardBy, TestOrder};

use super::past_run;
use crate::error::Failure;
use crate::history::{self, PastTests};

/// The word in `--shard-by duration=history`.
const HISTORY: &str = "history";

/// What past results are read for.
pub struct PastQuery<'a> {
    /// The address of the history, if it is not in the results directory.
    pub history: Option<&'a str>,
    /// The results directory.
    pub results: &'a Path,
    pub manifest: &'a Manifest,
    /// The working directory of the run.
    pub dir: &'a Path,
}

impl PastQuery<'_> {
    fn history(&self) -> Result<Result<Arc<PastTests>, StoreError>, Failure> {
        let path = history::resolve(self.history, self.results)?;
        let profile = self.manifest.profile.as_deref();
        Ok(PastTests::of_history(&path, profile, self.dir).map(Arc::new))
    }

    /// The past results for an order. Without a history, warns: the order of the files is as
    /// good for the first run.
    pub fn order(
        &self,
        order: TestOrder,
        warnings: &mut Vec<Diagnostic>,
    ) -> Result<Option<(TestOrder, Arc<PastTests>)>, Failure> {
        match self.history()? {
            Ok(past) => Ok(Some((order, past))),
            Err(error) => {
                let message = format!("{error}: the tests run in the order of their files");
                let warning = Diagnostic::warning("no-order", message);
                warnings.push(match error.hint() {
                    Some(hint) => warning.hint(hint),
                    None => warning,
                });
                Ok(None)
            }
        }
    }

    /// Adds the method that assigns tests to shards: the value of `--shard-by`.
    pub fn assign(
        &self,
        shard: Shard,
        method: &str,
    ) -> Result<(Shard, Option<Arc<PastTests>>), Failure> {
        let mut past = None;
        let by = match method.split_once('=') {
            None if method == "hash" => ShardBy::Hash,
            None if method == "count" => ShardBy::Count,
            Some(("duration", HISTORY)) => {
                past = Some(self.history()?.map_err(no_durations)?);
                ShardBy::Duration(HashMap::new())
            }
            Some(("duration", file)) if is_durations_file(file) => {
                past = Some(Arc::new(PastTests::of_durations(Path::new(file), self.dir)?));
                ShardBy::Duration(HashMap::new())
            }
            Some(("duration", run)) => {
                ShardBy::Duration(durations(&past_run::read(self.results, run)?))
            }
            _ => {
                let error = format!(
                    "`--shard-by {method}`: expected `hash`, `count`, `duration=history`, \
                     `duration=RUN` or `duration=FILE.json`"
                );
                return Err(Failure::input(error));
            }
        };
        Ok((Shard { by, ..shard }, past))
    }
}

fn is_durations_file(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension == "json")
}

/// Another shard may have a history: they would not fit together.
fn no_durations(error: StoreError) -> Failure {
    Failure::input(error)
        .hint("`--shard-by hash` needs no history; all shards must use the same method")
}

fn durations(record: &Record) -> PastResults {
    let past = |duration: Duration| PastResult { failed: false, duration: Some(duration) };
    let tests = record.tests.iter();
    tests.filter_map(|test| Some((past_run::names(record, test)?, past(test.duration())))).collect()
}
