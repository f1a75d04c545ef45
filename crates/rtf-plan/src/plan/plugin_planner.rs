//! Plans the plug-ins of one suite: finds their files and hosts, and records
//! which files have to be checked.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rtf_model::Diagnostic;

use super::checks::PluginUse;
use super::context::PlanContext;
use super::framework_kind::TestSubject;
use super::host_kind::HostKind;
use super::input_file::DirectPlugin;
use super::plugin_search::{self, PluginFinder};
use super::program::{self, utf8};
use super::search_scope::{Env, SearchScope, search_variables};
use super::use_site::{PluginRole, UseSite, UseSites};
use super::{HostPlan, PluginPlan};
use crate::suite::{DeclaredPlugin, SourceText, split_param};

/// Plans the plug-ins of one suite.
pub(super) struct PluginPlanner<'a, 'c> {
    pub context: &'c mut PlanContext<'a>,
    scope: SearchScope<'c>,
    finder: PluginFinder,
    hosts: HashMap<&'static str, Option<Arc<HostPlan>>>,
    types: HashMap<&'static str, Arc<str>>,
    /// The missing plug-ins and their uses.
    missing: Vec<(Diagnostic, UseSites)>,
    missing_index: HashMap<(String, &'static str), usize>,
}

/// The maximum number of missing plug-ins per suite for which similar names are searched.
const MAX_SUGGESTIONS: usize = 20;

impl<'a, 'c> PluginPlanner<'a, 'c> {
    pub fn new(context: &'c mut PlanContext<'a>, scope: SearchScope<'c>) -> Self {
        Self {
            context,
            scope,
            finder: PluginFinder::default(),
            hosts: HashMap::new(),
            types: HashMap::new(),
            missing: Vec::new(),
            missing_index: HashMap::new(),
        }
    }

    pub fn scope(&self) -> SearchScope<'c> {
        self.scope
    }

    /// Plans a plug-in of a suite; reports it if it is missing.
    pub fn plan(
        &mut self,
        declared: DeclaredPlugin,
        source: &Arc<SourceText>,
        env: &Env,
        role: PluginRole,
    ) -> Option<PluginPlan> {
        let kind = match plugin_search::kind_of(&declared, role) {
            Ok(kind) => kind,
            Err(problem) => {
                let span = declared.plugin_type.map_or(declared.name.span, |it| it.span);
                self.context.problems.push(problem.label(source.label(span, "")));
                return None;
            }
        };
        let name = &declared.name.value;
        let site = UseSite::Suite(Arc::clone(source), declared.name.span);
        let env = search_variables(env);
        let scope = self.scope.with(&env);
        let file = if env.is_empty() {
            self.finder.find(name, kind, &scope)
        } else {
            PluginFinder::default().find(name, kind, &scope)
        };
        let is_untyped = role == PluginRole::Fixture && declared.plugin_type.is_none();
        let shipped = is_untyped.then(|| plugin_search::shipped(name, &scope)).flatten();
        // Middleware has libraries with the names of shipped plug-ins: `librosbag.so`.
        let is_plugin =
            |file: &PathBuf| shipped.is_none() || plugin_search::is_in_user_dir(file, &scope);
        let found = file.filter(is_plugin).map(|file| (file, kind)).or(shipped);
        let Some((file, kind)) = found else {
            // Locates the host as well, to report a missing one at once.
            self.host(kind, &env, &site);
            self.record_missing(name, kind, &env, &site);
            return None;
        };
        let usage = PluginUsage { kind, role, env: &env, site: &site, optional: false };
        self.finish(&file, declared.param, usage)
    }

    /// Plans a plug-in that is given directly.
    pub fn plan_file(&mut self, direct: &DirectPlugin) -> Option<PluginPlan> {
        let options = self.context.options;
        let DirectPlugin { file, kind, from_dir } = direct;
        let param =
            if options.apply_to_plugin(*from_dir) { options.param.clone() } else { String::new() };
        let (role, site) = (PluginRole::Test, &UseSite::CommandLine);
        self.finish(
            &file.path,
            param,
            PluginUsage { kind, role, env: &[], site, optional: *from_dir },
        )
    }

    /// Plans a shipped fixture manager that the suite does not name.
    pub fn plan_shipped(
        &mut self,
        file: &Path,
        kind: &'static HostKind,
        param: String,
        site: &UseSite,
    ) -> Option<PluginPlan> {
        let role = PluginRole::Fixture;
        self.finish(file, param, PluginUsage { kind, role, env: &[], site, optional: false })
    }

    /// Plans a plug-in that is part of its host, with its parameter string and arguments. `file`
    /// is only shown.
    pub fn plan_built_in(
        &mut self,
        kind: &'static HostKind,
        file: &str,
        (param, args): (String, Vec<String>),
        site: &UseSite,
    ) -> Option<PluginPlan> {
        let (host, plugin_type) = (self.host(kind, &[], site)?, Arc::from(kind.name));
        Some(PluginPlan { plugin_type, file: file.into(), param, args, host })
    }

    fn finish(&mut self, file: &Path, param: String, usage: PluginUsage<'_>) -> Option<PluginPlan> {
        if let Err(problem) = utf8(file) {
            self.context.problems.push(usage.site.label(*problem, ""));
            return None;
        }
        let is_program = usage.kind.framework.is_some_and(|it| it.subject == TestSubject::Program);
        if is_program {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            let problem = program::interpreter_problem(&name, file, &self.scope.with(usage.env));
            if let Some(problem) = problem {
                self.context.problems.push(usage.site.label(*problem, ""));
                return None;
            }
        }
        let host = self.host(usage.kind, usage.env, usage.site)?;
        // The checks of other frameworks are added for the selected tests.
        if usage.kind.framework.is_none() {
            self.context.checks.add(PluginUse {
                host: &host,
                scope: &self.scope.with(usage.env),
                file,
                role: usage.role,
                site: usage.site,
                optional: usage.optional,
                arguments: &[],
                framework: None,
            });
        }
        let name = usage.kind.name;
        let plugin_type = Arc::clone(self.types.entry(name).or_insert_with(|| Arc::from(name)));
        let args = split_param(&param);
        Some(PluginPlan { plugin_type, file: file.to_path_buf(), param, args, host })
    }

    /// Locates the host of a type; reports a missing one once.
    fn host(
        &mut self,
        kind: &'static HostKind,
        env: &Env,
        site: &UseSite,
    ) -> Option<Arc<HostPlan>> {
        if env.is_empty()
            && let Some(known) = self.hosts.get(kind.name)
        {
            return known.clone();
        }
        let located = match kind.locate(&self.scope.with(env)) {
            Ok(host) => Some(self.context.share(host)),
            Err(problem) => {
                self.context.problems.push(site.label(*problem, "needed here"));
                None
            }
        };
        if env.is_empty() {
            self.hosts.insert(kind.name, located.clone());
        }
        // Several types have the same SDK.
        if let Some(hidden) = kind.sdk.and_then(|sdk| sdk.hidden_module(&self.scope))
            && !self.context.problems.contains(&hidden)
        {
            self.context.problems.push(hidden);
        }
        located
    }

    fn record_missing(&mut self, name: &str, kind: &'static HostKind, env: &Env, site: &UseSite) {
        let next = self.missing.len();
        let index = *self.missing_index.entry((name.to_owned(), kind.name)).or_insert(next);
        if index == next {
            let suggest = next < MAX_SUGGESTIONS;
            let problem = plugin_search::not_found(name, kind, &self.scope.with(env), suggest);
            self.missing.push((problem, UseSites::default()));
        }
        self.missing[index].1.add(site);
    }

    pub fn report_missing(self) {
        let problems = self.missing.into_iter().map(|(problem, sites)| sites.label(problem, ""));
        self.context.problems.extend(problems);
    }
}

struct PluginUsage<'a> {
    kind: &'static HostKind,
    role: PluginRole,
    /// The variables that affect the search.
    env: &'a Env,
    site: &'a UseSite,
    optional: bool,
}
