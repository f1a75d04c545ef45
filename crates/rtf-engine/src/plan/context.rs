//! What the planners of all suites share.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rtf_model::Diagnostic;

use super::hosts::{self, HostKind};
use super::plugin::{self, Finder};
use super::scope::{Env, Scope, decisive};
use super::verify::{Checks, Wanted};
use super::{HostPlan, Manner, Options, PluginPlan};
use crate::config::{self, Files, View};
use crate::suite::{Plugin, Source, Span, Suite, split_param};

/// Where a problem is shown.
#[derive(Clone, Debug)]
pub(super) enum Place {
    /// In a suite.
    In(Arc<Source>, Span),
    /// Nowhere: the plug-in was given on the command line.
    CommandLine,
}

impl Place {
    /// The diagnostic with this place after those that it has.
    pub fn show(&self, problem: Diagnostic, text: &str) -> Diagnostic {
        match self {
            Self::In(source, span) => problem.label(source.label(*span, text)),
            Self::CommandLine => problem,
        }
    }
}

/// What a plug-in is used as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Role {
    Test,
    Fixture,
    Hook,
}

impl Role {
    /// The kind of plug-in that it takes, in the word of the protocol and of messages.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Test | Self::Hook => "test",
            Self::Fixture => "fixture",
        }
    }

    /// What to do with a plug-in of the other kind.
    pub fn advice(self) -> &'static str {
        match self {
            Self::Test => "in a suite it is written as `<fixture>`",
            Self::Fixture => "in a suite it is written as `<test>`",
            Self::Hook => "a hook is a test plug-in, which did its work when it passes",
        }
    }
}

/// Shared by the planners of all suites.
pub(super) struct Context<'a> {
    /// What the user asked for.
    pub options: &'a Options,
    /// What is wrong so far.
    pub problems: Vec<Diagnostic>,
    /// What the hosts will be asked to look at.
    pub checks: Checks,
    /// The `rtf.toml` files.
    pub files: Files,
    hosts: Vec<Arc<HostPlan>>,
}

impl<'a> Context<'a> {
    /// A context without problems.
    pub fn new(options: &'a Options) -> Self {
        let files = match options.manner {
            Manner::Own => Files::new(&options.surroundings.current_folder),
            Manner::Predecessor => Files::none(),
        };
        Self { options, problems: Vec::new(), checks: Checks::default(), files, hosts: Vec::new() }
    }

    /// Lays the nearest `rtf.toml` over a suite.
    pub fn configure(&mut self, folder: &Path, source: &Source, suite: &mut Suite) {
        let Options { asked, surroundings, .. } = self.options;
        let view = self.files.above(folder).map(|file| View::of(file, asked));
        let user = &surroundings.variables;
        let mut problems = config::lay(suite, source, view.as_ref(), (asked, user));
        // What is not there may be in what could not be read.
        if self.files.problems.iter().any(|problem| problem.code == "not-toml") {
            problems.clear();
        }
        self.problems.append(&mut problems);
    }

    /// What holds for plug-ins that are given directly.
    pub fn config_of_singles(&mut self, folder: &Path, environment: &str) -> config::Singles {
        let Options { asked, surroundings, .. } = self.options;
        let view = self.files.above(folder).map(|file| View::of(file, asked));
        config::of_singles(view.as_ref(), environment, (asked, &surroundings.variables))
    }

    /// The host, shared with whoever needs the same.
    fn share(&mut self, host: HostPlan) -> Arc<HostPlan> {
        if let Some(known) = self.hosts.iter().find(|known| ***known == host) {
            return Arc::clone(known);
        }
        let host = Arc::new(host);
        self.hosts.push(Arc::clone(&host));
        host
    }
}

/// Plans the plug-ins of one suite.
pub(super) struct PluginPlanner<'a, 'c> {
    /// What all suites share.
    pub context: &'c mut Context<'a>,
    /// The suite's scope.
    scope: Scope<'c>,
    finder: Finder,
    hosts: HashMap<&'static str, Option<Arc<HostPlan>>>,
    types: HashMap<&'static str, Arc<str>>,
    /// Plug-ins that were not found, and where they are written.
    missing: Vec<Missing>,
    missing_index: HashMap<(String, &'static str), usize>,
}

struct Missing {
    problem: Diagnostic,
    places: usize,
}

/// For so many missing plug-ins of a suite others of a similar name are searched.
const ADVISED_MISSING: usize = 20;

/// Places of one problem that are shown; the others are counted.
const SHOWN_PLACES: usize = 3;

impl<'a, 'c> PluginPlanner<'a, 'c> {
    /// A planner for plug-ins in `scope`.
    pub fn new(context: &'c mut Context<'a>, scope: Scope<'c>) -> Self {
        Self {
            context,
            scope,
            finder: Finder::new(),
            hosts: HashMap::new(),
            types: HashMap::new(),
            missing: Vec::new(),
            missing_index: HashMap::new(),
        }
    }

    /// The suite's scope.
    pub fn scope(&self) -> Scope<'c> {
        self.scope
    }

    /// Finds a plug-in that a suite names; reports what is not there.
    pub fn plan(
        &mut self,
        written: Plugin,
        source: &Arc<Source>,
        env: &Env,
        role: Role,
    ) -> Option<PluginPlan> {
        let kind = match plugin::kind_of(&written, role) {
            Ok(kind) => kind,
            Err(problem) => {
                let span = written.plugin_type.map_or(written.name.span, |written| written.span);
                self.context.problems.push(problem.label(source.label(span, "")));
                return None;
            }
        };
        let place = Place::In(Arc::clone(source), written.name.span);
        let own = decisive(env);
        let file = if own.is_empty() {
            self.finder.find(&written.name.value, kind, &self.scope)
        } else {
            Finder::new().find(&written.name.value, kind, &self.scope.with(&own))
        };
        let untyped = role == Role::Fixture && written.plugin_type.is_none();
        let ours = untyped.then(|| plugin::shipped(&written.name.value, &self.scope)).flatten();
        // Middleware has libraries of these names: `librosbag.so` is no plug-in.
        let theirs = file
            .filter(|file| ours.is_none() || plugin::is_beside_suite(file, &self.scope.with(&own)));
        let Some((file, kind)) = theirs.map(|file| (file, kind)).or(ours) else {
            // The host is missed as well as the plug-in, not after it.
            self.host(kind, &own, &place);
            self.note_missing(&written.name.value, kind, &own, &place);
            return None;
        };
        let use_of = Use { kind, role, own: &own, place: &place, from_folder: false };
        self.finish(&file, written.param, use_of)
    }

    /// Plans a plug-in whose file is known.
    pub fn plan_file(
        &mut self,
        file: &Path,
        kind: &'static HostKind,
        from_folder: bool,
    ) -> Option<PluginPlan> {
        let options = self.context.options;
        let param =
            if options.are_for(from_folder) { options.param.clone() } else { String::new() };
        let place = &Place::CommandLine;
        self.finish(file, param, Use { kind, role: Role::Test, own: &[], place, from_folder })
    }

    /// Plans a fixture that comes with rtf, and that the suite does not name.
    pub fn plan_shipped(
        &mut self,
        file: &Path,
        kind: &'static HostKind,
        param: String,
        place: &Place,
    ) -> Option<PluginPlan> {
        let role = Role::Fixture;
        self.finish(file, param, Use { kind, role, own: &[], place, from_folder: false })
    }

    fn finish(&mut self, file: &Path, param: String, use_of: Use<'_>) -> Option<PluginPlan> {
        if let Err(problem) = hosts::text(file) {
            self.context.problems.push(use_of.place.show(*problem, ""));
            return None;
        }
        let host = self.host(use_of.kind, use_of.own, use_of.place)?;
        self.context.checks.want(Wanted {
            host: &host,
            scope: &self.scope.with(use_of.own),
            file,
            role: use_of.role,
            place: use_of.place,
            optional: use_of.from_folder,
        });
        let name = use_of.kind.name;
        let plugin_type = Arc::clone(self.types.entry(name).or_insert_with(|| Arc::from(name)));
        let args = split_param(&param);
        Some(PluginPlan { plugin_type, file: file.to_path_buf(), param, args, host })
    }

    /// The host of a type; that it is not there is reported once.
    fn host(&mut self, kind: &'static HostKind, own: &Env, place: &Place) -> Option<Arc<HostPlan>> {
        if own.is_empty()
            && let Some(known) = self.hosts.get(kind.name)
        {
            return known.clone();
        }
        let located = match kind.locate(&self.scope.with(own)) {
            Ok(host) => Some(self.context.share(host)),
            Err(problem) => {
                self.context.problems.push(place.show(*problem, "needed here"));
                None
            }
        };
        if own.is_empty() {
            self.hosts.insert(kind.name, located.clone());
        }
        located
    }

    fn note_missing(&mut self, name: &str, kind: &'static HostKind, own: &Env, place: &Place) {
        let key = (name.to_owned(), kind.name);
        if let Some(index) = self.missing_index.get(&key) {
            let known = &mut self.missing[*index];
            known.places += 1;
            if known.places <= SHOWN_PLACES {
                known.problem = place.show(known.problem.clone(), "and here");
            }
            return;
        }
        let problem = plugin::not_found(
            name,
            kind,
            &self.scope.with(own),
            self.missing.len() < ADVISED_MISSING,
        );
        self.missing_index.insert(key, self.missing.len());
        self.missing.push(Missing { problem: place.show(problem, ""), places: 1 });
    }

    /// Reports the plug-ins that were not found.
    pub fn report_missing(self) {
        for missing in self.missing {
            let more = missing.places.saturating_sub(SHOWN_PLACES);
            self.context.problems.push(match more {
                0 => missing.problem,
                _ => missing.problem.note(format!("needed in {more} more places of this suite")),
            });
        }
    }
}

/// One use of a plug-in.
struct Use<'a> {
    kind: &'static HostKind,
    role: Role,
    own: &'a Env,
    place: &'a Place,
    from_folder: bool,
}

/// The folder of a file, absolute.
pub(super) fn folder_of(file: &Path) -> PathBuf {
    file.parent().map(Path::to_path_buf).unwrap_or_default()
}
