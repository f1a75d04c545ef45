//! Safety envelopes: a YAML file with the limits of a robot → monitors of its signals.
//!
//! Responsible for the file, for the model (URDF, MJCF) to which it refers, and for the formulas.
//! `spec/envelopes.md` specifies them.

mod bound;
mod compile;
mod file;
mod joint;
mod limit;
mod mjcf;
mod model;
mod patch;
mod schema;
mod urdf;
mod yaml;

use std::path::Path;
use std::sync::Arc;

use rtf_model::{Diagnostic, FindingSeverity, Location};

pub use schema::json_schema;

use crate::suite::{DeclaredSignal, SourceText, read_source};
use crate::wording::suggest;

/// A limit, as a monitor.
#[derive(Clone, Debug)]
pub(crate) struct EnvelopeMonitor {
    /// The name, with that of the robot.
    pub name: String,
    pub formula: String,
    pub severity: FindingSeverity,
    /// The file and line of the limit.
    pub location: Location,
    /// The file, line and column of the limit.
    pub origin: String,
}

/// What a file of limits is compiled for.
pub(crate) struct EnvelopeRequest<'a> {
    /// The directory of the suite.
    pub dir: &'a Path,
    /// The file, relative to this directory.
    pub file: &'a str,
    /// The name of the directory in messages; empty for the current one.
    pub shown_dir: &'a Path,
    /// The selected profile.
    pub profile: Option<&'a str>,
    /// The profiles of the suite's `rtf.toml`.
    pub known_profiles: &'a [String],
    pub signals: &'a [&'a DeclaredSignal],
}

#[derive(Debug, Default)]
pub(crate) struct CompiledEnvelope {
    /// The monitors; those of a file with errors are incomplete.
    pub monitors: Vec<EnvelopeMonitor>,
    /// The problems; without a label if the file itself cannot be read.
    pub problems: Vec<Diagnostic>,
    pub sources: Vec<Arc<SourceText>>,
}

/// Parses the text of a file of limits with all of its profiles, and reports every problem that needs
/// neither signals nor a model.
pub fn check_text(source: &SourceText, problems: &mut Vec<Diagnostic>) {
    let Some(mut root) = yaml::parse(source, problems) else { return };
    let parts = patch::take_profiles(&mut root, source, problems);
    file::read(&root, source, problems);
    for (_, part) in parts {
        file::read(&part, source, problems);
        patch::apply(&mut root, part);
    }
}

impl EnvelopeRequest<'_> {
    pub fn compile(&self) -> CompiledEnvelope {
        let mut compiled = CompiledEnvelope::default();
        let Some(source) = read(self.dir, self.shown_dir, self.file, &mut compiled) else {
            return compiled;
        };
        let problems = &mut compiled.problems;
        let Some(mut root) = yaml::parse(&source, problems) else { return compiled };
        let parts = patch::take_profiles(&mut root, &source, problems);
        // Each part is checked, and the selected one is applied.
        file::read(&root, &source, problems);
        for (name, part) in &parts {
            file::read(part, &source, problems);
            if !self.known_profiles.contains(&name.value) {
                let message = format!("there is no profile `{}` in `rtf.toml`", name.value);
                let problem = Diagnostic::warning("unknown-profile", message);
                let known = self.known_profiles.iter().map(String::as_str);
                let problem = suggest(problem, &name.value, known);
                problems.push(problem.label(source.label(name.span, "")));
            }
        }
        if let Some((_, part)) =
            parts.into_iter().find(|(name, _)| Some(&*name.value) == self.profile)
        {
            patch::apply(&mut root, part);
        }
        let mut repeated = Vec::new();
        let file = file::read(&root, &source, &mut repeated);
        let before = problems.len();
        let model =
            file.model.as_ref().and_then(|name| model::load(self, name, &source, &mut compiled));
        // Without its limits, each joint would be a further problem.
        if compiled.problems.len() > before && model.is_none() {
            return compiled;
        }
        compile::Compiler { request: self, source: &source, file: &file, model: model.as_ref() }
            .run(&mut compiled);
        compiled
    }
}

/// Reads a text that messages name by its path from the current directory.
fn read(
    dir: &Path,
    shown_dir: &Path,
    file: &str,
    compiled: &mut CompiledEnvelope,
) -> Option<Arc<SourceText>> {
    let name = shown_dir.join(file).to_string_lossy().into_owned();
    match read_source(&dir.join(file), &name) {
        Ok(source) => {
            let source = Arc::new(source);
            compiled.sources.push(Arc::clone(&source));
            Some(source)
        }
        Err(unreadable) => {
            compiled.problems.push(unreadable.problem);
            compiled.sources.extend(unreadable.source.map(Arc::new));
            None
        }
    }
}
