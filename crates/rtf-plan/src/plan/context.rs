//! The state shared by the planners of all suites.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rtf_model::Diagnostic;

use super::checks::PluginChecks;
use super::quarantines::Quarantines;
use super::{Compatibility, HostPlan, Options, SuitePlan};
use crate::config::{self, ConfigFiles, ProfileView};
use crate::suite::{DeclaredSuite, SourceText};

/// The state shared by the planners of all suites.
pub(super) struct PlanContext<'a> {
    pub options: &'a Options,
    pub problems: Vec<Diagnostic>,
    pub checks: PluginChecks,
    /// The texts of further files to which problems refer.
    pub sources: Vec<Arc<SourceText>>,
    pub files: ConfigFiles,
    pub quarantines: Quarantines,
    hosts: Vec<Arc<HostPlan>>,
}

impl<'a> PlanContext<'a> {
    pub fn new(options: &'a Options) -> Self {
        let files = match options.compatibility {
            Compatibility::Native => ConfigFiles::new(&options.runner.current_dir),
            Compatibility::Predecessor => ConfigFiles::disabled(),
        };
        let (problems, checks) = (Vec::new(), PluginChecks::default());
        let quarantines = Quarantines::default();
        let (sources, hosts) = (Vec::new(), Vec::new());
        Self { options, problems, checks, sources, files, quarantines, hosts }
    }

    /// Overlays the nearest `rtf.toml` on a suite.
    pub fn configure(&mut self, dir: &Path, source: &SourceText, suite: &mut DeclaredSuite) {
        let Options { config_request, runner, .. } = self.options;
        let view = self.profile_view(dir);
        let user = &runner.variables;
        let mut problems =
            config::overlay_suite(suite, source, view.as_ref(), (config_request, user));
        // A value that seems missing may be in the unreadable part of the file.
        if self.files.problems.iter().any(|problem| problem.code == "not-toml") {
            problems.clear();
        }
        self.problems.append(&mut problems);
    }

    pub fn direct_plugin_config(
        &mut self,
        dir: &Path,
        environment: &str,
    ) -> config::DirectPluginConfig {
        let Options { config_request, runner, .. } = self.options;
        let view = self.profile_view(dir);
        config::direct_plugin_config(
            view.as_ref(),
            environment,
            (config_request, &runner.variables),
        )
    }

    /// Marks the quarantined tests of a suite whose files are in `dir`.
    pub fn quarantine(&mut self, dir: &Path, suite: &mut SuitePlan) {
        if let Some(view) = self.profile_view(dir) {
            self.quarantines.apply(&view, suite, self.options.today);
        }
    }

    /// Returns the selected profile of a directory, and all of its profiles.
    pub fn profiles(&mut self, dir: &Path) -> (Option<String>, Vec<String>) {
        let Some(view) = self.profile_view(dir) else { return (None, Vec::new()) };
        let known = view.file.profiles.iter().map(|(name, _)| name.value.clone()).collect();
        (view.profile.map(|(name, _)| name), known)
    }

    fn profile_view(&mut self, dir: &Path) -> Option<ProfileView> {
        let file = self.files.find_nearest(dir)?;
        Some(ProfileView::new(file, &self.options.config_request))
    }

    /// Returns the plan of a host, shared with all other uses of it.
    pub fn share(&mut self, host: HostPlan) -> Arc<HostPlan> {
        if let Some(known) = self.hosts.iter().find(|known| ***known == host) {
            return Arc::clone(known);
        }
        let host = Arc::new(host);
        self.hosts.push(Arc::clone(&host));
        host
    }
}

/// Returns the directory of a file with an absolute path.
pub(super) fn parent_dir(file: &Path) -> PathBuf {
    file.parent().map(Path::to_path_buf).unwrap_or_default()
}
