//! The plug-ins to check, and the diagnostics that follow from the answers.
//!
//! Before a run, each host is started with `--check` and all of its files, in
//! the directory and with the variables that its processes will have. This
//! finds missing symbols, wrong ABI versions, syntax errors and fixtures used as
//! tests before anything has moved. This module collects the files and judges
//! the answers; `rtf-engine` starts the hosts.

mod diagnose;

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use rtf_model::Diagnostic;
use serde::Deserialize;

use super::framework_kind::Framework;
use super::search_scope::SearchScope;
use super::use_site::{PluginRole, UseSite, UseSites};
use super::{HostPlan, ListedCase};
use crate::suite::SourceMap;

/// A use of a plug-in that has to be checked.
pub(super) struct PluginUse<'a> {
    pub host: &'a Arc<HostPlan>,
    pub scope: &'a SearchScope<'a>,
    pub file: &'a Path,
    pub role: PluginRole,
    pub site: &'a UseSite,
    /// Whether the file is omitted, without an error, if it contains no plug-in of this role.
    pub optional: bool,
    /// The arguments with which its cases are listed; empty for other plug-ins.
    pub arguments: &'a [String],
    pub framework: Option<(&'static str, Framework)>,
}

/// The position of a file in the checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct CheckId {
    group: usize,
    file: usize,
}

/// All files to check, each once per way of loading it.
#[derive(Debug, Default)]
pub(super) struct PluginChecks {
    groups: Vec<CheckGroup>,
}

/// Files that the same host loads in the same way.
#[derive(Debug)]
pub struct CheckGroup {
    /// The host to start with `--check` and the files.
    pub host: Arc<HostPlan>,
    /// The working directory of the host.
    pub folder: PathBuf,
    /// Environment variables in addition to the runner's; later ones win.
    pub env: Vec<(String, String)>,
    /// The arguments for the programs of another framework, which list their cases.
    pub arguments: Vec<String>,
    /// The type, if it is another framework.
    framework: Option<(&'static str, Framework)>,
    files: Vec<FileUse>,
    index: HashMap<PathBuf, usize>,
}

impl CheckGroup {
    /// Returns the files to check, in the order of the answers that
    /// [`PlanDraft::finish`](super::PlanDraft::finish) expects.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(|entry| entry.file.as_path())
    }

    /// Whether the answers list cases, and not only problems.
    pub(super) fn lists_cases(&self) -> bool {
        self.framework.is_some()
    }

    /// Returns the limit for one file; `usual` unless the host needs longer.
    #[must_use]
    pub fn limit(&self, usual: Duration) -> Duration {
        let own = self.framework.and_then(|(_, framework)| framework.check_limit);
        own.map_or(usual, |own| own.max(usual))
    }
}

/// A host's answer about one file.
#[derive(Clone, Debug)]
pub enum CheckAnswer {
    Report(CheckReport),
    /// The host died while it loaded this file.
    Died {
        /// `exit code 3`, `signal 11`.
        how: String,
        /// The end of its standard error.
        stderr: String,
    },
    /// The host did not finish loading this file within this time.
    Silent(Duration),
    /// The host does not work at all.
    HostFailed {
        /// `exit code 3`, `it cannot be started: …`.
        how: String,
        /// The end of its standard error.
        stderr: String,
    },
}

/// One line of a host's output after `--check FILE…` (`spec/protocol.md`).
#[derive(Clone, Debug, Deserialize)]
pub struct CheckReport {
    /// The file, as passed to the host.
    pub file: String,
    /// Whether it could be loaded.
    pub ok: bool,
    /// The reason if it could not.
    pub message: Option<String>,
    /// The line of the file with the error, from 1.
    pub line: Option<u32>,
    /// The plug-ins in the file, `test` or `fixture`, if the host knows them.
    pub kinds: Option<Vec<String>>,
    /// The cases of a test of another framework; `None` if they are known only when it runs.
    pub cases: Option<Vec<ListedCase>>,
}

#[derive(Debug)]
struct FileUse {
    file: PathBuf,
    sites: BTreeMap<PluginRole, UseSites>,
    optional: bool,
}

#[derive(Default)]
pub(super) struct CheckFindings {
    pub problems: Vec<Diagnostic>,
    /// The plug-ins' texts to which the problems refer.
    pub sources: SourceMap,
    /// Files of input directories that contain no test.
    pub omitted: BTreeSet<PathBuf>,
    /// The cases of the files that could be loaded; `None` if the host does not list them.
    pub cases: HashMap<CheckId, Option<Arc<[ListedCase]>>>,
}

impl PluginChecks {
    pub fn add(&mut self, plugin: PluginUse<'_>) -> CheckId {
        let id = self.group(&plugin);
        let group = &mut self.groups[id];
        let index = match group.index.get(plugin.file) {
            Some(index) => *index,
            None => {
                let index = group.files.len();
                group.index.insert(plugin.file.to_path_buf(), index);
                group.files.push(FileUse {
                    file: plugin.file.to_path_buf(),
                    sites: BTreeMap::new(),
                    optional: plugin.optional,
                });
                index
            }
        };
        let entry = &mut group.files[index];
        entry.optional &= plugin.optional;
        entry.sites.entry(plugin.role).or_default().add(plugin.site);
        CheckId { group: id, file: index }
    }

    /// Returns the index of the group of a use.
    fn group(&mut self, plugin: &PluginUse<'_>) -> usize {
        let PluginUse { host, scope, arguments, .. } = plugin;
        let env = || scope.suite_env.iter().chain(scope.own_env);
        let is_same = |group: &CheckGroup| {
            Arc::ptr_eq(&group.host, host)
                && group.arguments == *arguments
                && group.folder == scope.dir
                && group.env.iter().eq(env())
        };
        // Searched backwards: most uses belong to the group of the previous one.
        match self.groups.iter().rposition(is_same) {
            Some(index) => index,
            None => {
                self.groups.push(CheckGroup {
                    host: Arc::clone(host),
                    folder: scope.dir.to_path_buf(),
                    env: env().cloned().collect(),
                    arguments: arguments.to_vec(),
                    framework: plugin.framework,
                    files: Vec::new(),
                    index: HashMap::new(),
                });
                self.groups.len() - 1
            }
        }
    }

    pub fn groups(&self) -> &[CheckGroup] {
        &self.groups
    }

    /// Turns the answers, one per file of each group, into diagnostics.
    pub fn diagnose(&self, answers: Vec<Vec<CheckAnswer>>) -> CheckFindings {
        let mut findings = CheckFindings::default();
        for (index, (group, answers)) in self.groups.iter().zip(answers).enumerate() {
            diagnose::diagnose(index, group, answers, &mut findings);
        }
        findings
    }
}
