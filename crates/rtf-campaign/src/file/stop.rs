//! `<stop>`: when a campaign ends.

use roxmltree::Node;
use rtf_model::Diagnostic;
use rtf_plan::suite::schema::check;
use rtf_plan::suite::{ElementReader, Spanned};
use serde::{Deserialize, Serialize};

use super::{Campaign, DeclaredParameter, real, schema};

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "rule", rename_all = "kebab-case")]
pub enum StoppingRule {
    /// After all episodes.
    #[default]
    Fixed,
    /// When the confidence sequence does not contain the claimed rate.
    ConfidenceSequence,
    /// When the sequential test accepts a rate.
    Sprt {
        /// The rate that must not pass.
        low: f64,
        /// The rate that must not fail.
        high: f64,
        /// The probability that `low` passes.
        alpha: f64,
        /// The probability that `high` fails.
        beta: f64,
    },
}

/// The values of `rule`; `None` for the one with further attributes.
const RULES: [(&str, Option<StoppingRule>); 3] = [
    ("fixed", Some(StoppingRule::Fixed)),
    ("confidence-sequence", Some(StoppingRule::ConfidenceSequence)),
    ("sprt", None),
];

/// Reads the `<stop>`; `None` if it is invalid, which is reported.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<StoppingRule> {
    let rule = reader.choice(node, "rule", &RULES);
    if let Some(Some(rule)) = rule {
        check(reader, node, &schema::STOP);
        return Some(rule);
    }
    check(reader, node, &schema::SPRT);
    if !node.has_attribute("rule") {
        reader.missing(node, "the attribute `rule`");
    }
    rule?;
    let [low, high] = ["low", "high"].map(|name| real::between_zero_and(reader, node, name, 1.0));
    let [alpha, beta] =
        ["alpha", "beta"].map(|name| real::between_zero_and(reader, node, name, 0.5));
    let (low, high, alpha, beta) = (low?, high?, alpha?.value, beta?.value);
    if low.value >= high.value {
        let text = Spanned::new(high.value.to_string(), high.span);
        reader.wrong("high", &text, &format!("has to be greater than `low`, {}", low.value), None);
        return None;
    }
    Some(StoppingRule::Sprt { low: low.value, high: high.value, alpha, beta })
}

/// Reports a stopping rule that does not fit the claim or the parameters.
pub(super) fn check_rule(reader: &mut ElementReader<'_>, campaign: &Campaign) {
    let Some(claim) = campaign.claim() else { return };
    match (campaign.stop, &claim.confidence) {
        (StoppingRule::Sprt { .. }, Some(confidence)) => {
            let message = "`confidence` has no effect with `rule=\"sprt\"`";
            let problem = reader
                .error("conflicting-attributes", confidence.span, message)
                .hint("`alpha` and `beta` are the error rates");
            reader.report(problem);
        }
        (StoppingRule::Fixed | StoppingRule::ConfidenceSequence, None) => {
            let problem = reader
                .error("incomplete", claim.span, "the claim needs a confidence")
                .hint("add `confidence=\"0.95\"` to `<claim>`");
            reader.report(problem);
        }
        _ => {}
    }
    if let StoppingRule::Sprt { low, high, .. } = campaign.stop
        && !(low..=high).contains(&claim.rate)
    {
        let message = format!("the claimed rate is not between `low`, {low}, and `high`, {high}");
        reader.report(reader.error("invalid-value", claim.span, message));
    }
    if campaign.stop != StoppingRule::Fixed {
        let dependent = |parameter: &&DeclaredParameter| !parameter.is_independent();
        for parameter in campaign.parameters.iter().filter(dependent) {
            let message = "a sequential stopping rule needs independent episodes";
            let problem = Diagnostic::error("dependent-episodes", message)
                .label(reader.source.label(parameter.span(), "the episodes depend on each other"))
                .hint("use `choice`, `uniform` or `normal`, or `<stop rule=\"fixed\"/>`");
            reader.report(problem);
        }
    }
}
