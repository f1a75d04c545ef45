//! `<claim>`.

use roxmltree::Node;
use rtf_plan::suite::schema::check;
use rtf_plan::suite::{ElementReader, Span, Spanned};

use super::{real, schema};

/// A claim about the rate of passed episodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The position of `require`.
    pub span: Span,
    /// The rate is at least this: between 0 and 1.
    pub rate: f64,
    /// The confidence of the interval, between 0.5 and 1; `None` if the stopping rule has error
    /// rates.
    pub confidence: Option<Spanned<f64>>,
}

/// Reads the `<claim>`; `None` if it is invalid, which is reported.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<Claim> {
    check(reader, node, &schema::CLAIM);
    let require = reader.required(node, "require", ": `rate >= 0.95`");
    let has_confidence = node.has_attribute("confidence");
    let confidence =
        if has_confidence { real::between_zero_and(reader, node, "confidence", 1.0) } else { None };
    if let Some(low) = confidence.as_ref().filter(|confidence| confidence.value <= 0.5) {
        let text = Spanned::new(low.value.to_string(), low.span);
        reader.wrong("confidence", &text, "has to be above 0.5", None);
    }
    let require = require?;
    let rate = parse(&require.value);
    if rate.is_none() {
        let hint = "write it like `rate >= 0.95`, with a rate between 0 and 1";
        reader.wrong("require", &require, "is not a claim", Some(hint));
    }
    let is_valid = has_confidence == confidence.is_some();
    Some(Claim { span: require.span, rate: rate?, confidence }).filter(|_| is_valid)
}

/// Parses `rate >= 0.95`.
fn parse(text: &str) -> Option<f64> {
    let rate = text.strip_prefix("rate")?.trim_start().strip_prefix(">=")?.trim_start();
    rate.parse::<f64>().ok().filter(|rate| *rate > 0.0 && *rate < 1.0)
}
