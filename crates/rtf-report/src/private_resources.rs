//! The private resources of a suite, line by line, for console, text and logs.

use rtf_model::{SuiteNetwork, SuitePrepared, SuiteVariable};

use crate::escape;
use crate::explain::{Sink, Tone};

/// Shows the private resources, and the command that joins the suite.
pub(crate) fn show(prepared: &SuitePrepared, sink: Sink<'_>) {
    if let Some(SuiteNetwork { pid, user_namespace }) = prepared.network {
        let user = if user_namespace { ", with a user namespace" } else { "" };
        sink(Tone::Plain, &format!("private network: held by process {pid}{user}"));
    }
    for own in &prepared.ports {
        sink(Tone::Plain, &format!("port {}: {}", escape::line(&own.name), own.port));
    }
    for variable in &prepared.variables {
        let yours = if variable.inherited { " (inherited)" } else { "" };
        sink(Tone::Plain, &format!("{}{yours}", assignment(variable)));
    }
    sink(Tone::Dim, &format!("join: {}", escape::line(&prepared.join_command)));
}

/// The variables that the user had set and that were kept.
pub(crate) fn kept(prepared: &SuitePrepared) -> String {
    let kept = prepared.variables.iter().filter(|variable| variable.inherited);
    let list: Vec<_> = kept.map(assignment).collect();
    format!("{} from your environment (`middleware=\"own\"` replaces it)", list.join(", "))
}

fn assignment(variable: &SuiteVariable) -> String {
    format!("{}={}", escape::line(&variable.name), escape::line(&variable.value))
}
