//! The names of the two sides of a comparison.

use std::collections::HashSet;

use crate::{RunSelection, Store, StoreError};

impl Store {
    /// Resolves one side of a comparison: `latest`, the name or id of a run, or all runs with
    /// an attribute, such as `branch:main`.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn comparison_side(
        &self,
        name: &str,
        base: &RunSelection,
    ) -> Result<RunSelection, StoreError> {
        let value = |text: &str| Some(text.to_owned());
        let base = base.clone();
        Ok(match name.split_once(':') {
            Some(("branch", branch)) => RunSelection { branch: value(branch), ..base },
            Some(("commit", commit)) => RunSelection { commit: value(commit), ..base },
            Some(("robot", robot)) => RunSelection { robot: value(robot), ..base },
            Some(("host", host)) => RunSelection { host: value(host), ..base },
            Some(("profile", profile)) => RunSelection { profile: value(profile), ..base },
            _ => {
                let runs = self.runs(&RunSelection::default())?;
                let is_meant = |run: &str| name == "latest" || name == run;
                let found = runs.into_iter().find(|run| is_meant(&run.name) || is_meant(&run.id));
                let ids: HashSet<String> = found.into_iter().map(|run| run.id).collect();
                RunSelection { ids: Some(ids), ..base }
            }
        })
    }
}
