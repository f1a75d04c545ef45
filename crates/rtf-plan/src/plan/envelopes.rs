//! `<envelope>`: the limits of a file become monitors of all tests.

use std::path::Path;
use std::sync::Arc;

use rtf_model::{Diagnostic, MonitorConfig};

use super::context::{PlanContext, parent_dir};
use crate::envelope::EnvelopeRequest;
use crate::suite::{DeclaredEnvelope, DeclaredSignal, SourceText};

/// Adds the monitors of the files, and reports every problem of them.
pub(super) fn plan(
    context: &mut PlanContext<'_>,
    source: &SourceText,
    ((dir, envelopes), signals): ((&Path, &[DeclaredEnvelope]), &[&DeclaredSignal]),
    monitors: &mut Vec<MonitorConfig>,
) {
    if envelopes.is_empty() {
        return;
    }
    let shown_dir = parent_dir(Path::new(source.name()));
    let (profile, known_profiles) = context.profiles(dir);
    for envelope in envelopes {
        let request = EnvelopeRequest {
            dir,
            file: &envelope.file.value,
            shown_dir: &shown_dir,
            profile: profile.as_deref(),
            known_profiles: &known_profiles,
            signals,
        };
        let compiled = request.compile();
        let problems = compiled.problems.into_iter();
        context.problems.extend(problems.map(|it| source.locate(it, envelope.file.span)));
        context.sources.extend(compiled.sources.iter().map(Arc::clone));
        for monitor in compiled.monitors {
            if monitors.iter().any(|known| known.name == monitor.name) {
                let message = format!("a second monitor `{}`", monitor.name);
                let problem = Diagnostic::error("duplicate-name", message)
                    .label(source.label(envelope.span, format!("from {}", monitor.origin)))
                    .hint("give each file another `robot`, which precedes the names");
                context.problems.push(problem);
                continue;
            }
            monitors.push(MonitorConfig {
                name: monitor.name,
                formula: monitor.formula,
                severity: monitor.severity,
                location: monitor.location,
                origin: Some(monitor.origin),
                tests: None,
            });
        }
    }
}
