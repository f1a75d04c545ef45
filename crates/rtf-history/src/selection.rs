//! Which runs and tests a question is about.

use std::collections::HashSet;

use jiff::Timestamp;

use crate::TestIdentity;
use crate::answers::RunInfo;
use crate::entry::CampaignInfo;

/// Which runs a question is about. The default is all runs.
#[derive(Clone, Debug, Default)]
pub struct RunSelection {
    pub branch: Option<String>,
    /// Only runs of commits whose hash starts with this.
    pub commit: Option<String>,
    /// Only results of suites that require this resource.
    pub robot: Option<String>,
    pub profile: Option<String>,
    /// Only runs on this machine.
    pub host: Option<String>,
    /// Only runs that started at this time or later.
    pub since: Option<Timestamp>,
    /// Only the newest of the remaining runs.
    pub last: Option<usize>,
    /// Only runs with these identities.
    pub ids: Option<HashSet<String>>,
}

impl RunSelection {
    /// Applies everything except `last` and `robot` to a run.
    #[must_use]
    pub fn matches(&self, run: &RunInfo) -> bool {
        let RunInfo { branch, profile, host, commit, .. } = run;
        self.matches_source([branch, profile, host, commit].map(Option::as_deref), run.started)
            && self.ids.as_ref().is_none_or(|ids| ids.contains(&run.id))
    }

    /// Applies everything except `last`, `robot` and `ids`, which are those of runs, to a
    /// campaign.
    #[must_use]
    pub fn matches_campaign(&self, campaign: &CampaignInfo) -> bool {
        let CampaignInfo { branch, profile, host, commit, .. } = campaign;
        let source = [branch.as_deref(), profile.as_deref(), Some(host), commit.as_deref()];
        self.matches_source(source, campaign.started)
    }

    fn matches_source(
        &self,
        [branch, profile, host, commit]: [Option<&str>; 4],
        started: Timestamp,
    ) -> bool {
        let equals = |wanted: &Option<String>, found: Option<&str>| {
            wanted.is_none() || wanted.as_deref() == Some(found.unwrap_or_default())
        };
        let commit = commit.unwrap_or_default();
        equals(&self.branch, branch)
            && equals(&self.profile, profile)
            && equals(&self.host, host)
            && self.commit.as_deref().is_none_or(|start| commit.starts_with(start))
            && self.since.is_none_or(|since| started >= since)
    }

    /// Whether a result on these robots (names separated by spaces) is meant.
    #[must_use]
    pub fn matches_robot(&self, robots: &str) -> bool {
        self.robot.as_deref().is_none_or(|wanted| robots.split(' ').any(|name| name == wanted))
    }
}

/// A test, for a [`TestSelection`].
#[derive(Clone, Debug, Default)]
pub struct TestAttributes {
    pub identity: TestIdentity,
    /// The type of its plug-in in its newest run.
    pub plugin_type: String,
    /// Its tags in its newest run.
    pub tags: Vec<String>,
    /// Its values of a matrix, as name and value.
    pub parameters: Vec<(String, String)>,
}

/// Which tests a question is about: a condition on each of them.
pub type TestSelection<'a> = &'a dyn Fn(&TestAttributes) -> bool;
