//! The keys of a file of limits.

use rtf_model::{Diagnostic, FindingSeverity};

use super::bound::Bound;
use super::limit::{DeclaredLimit, Input, Quantity};
use super::patch::PROFILES;
use super::yaml::{Node, Value};
use crate::suite::{SourceText, Span, Spanned, parse_duration};
use crate::wording::{quoted, suggest};

const FILE_KEYS: [&str; 9] =
    ["robot", "model", "severity", "factor", "signals", "ignore", "joints", "limits", PROFILES];
pub(super) const LIMIT_KEYS: [&str; 6] = ["signal", "rate-of", "min", "max", "for", "severity"];
/// The keys of a limit of a magnitude.
const MAGNITUDE_KEYS: [&str; 5] = ["signal", "rate-of", "max", "for", "severity"];
/// What a name of a signal contains in place of the joint.
pub(super) const JOINT: &str = "{joint}";
/// The signal that is the slope of another quantity.
pub(super) const RATE: &str = "rate";

/// The name of the signals of a quantity.
#[derive(Clone, Debug)]
pub(super) struct Template {
    pub quantity: Quantity,
    /// A text with `{joint}`, or `rate`.
    pub text: Spanned<String>,
}

#[derive(Clone, Debug)]
pub(super) struct DeclaredJoint {
    pub name: Spanned<String>,
    pub limits: Vec<(Quantity, DeclaredLimit)>,
}

/// A file of limits, or the part for a profile.
#[derive(Clone, Debug, Default)]
pub(super) struct LimitsFile {
    pub robot: Option<Spanned<String>>,
    /// The file of the model.
    pub model: Option<Spanned<String>>,
    pub severity: Option<FindingSeverity>,
    /// What tightens limits.
    pub factor: Option<f64>,
    pub templates: Vec<Template>,
    /// Joints without limits.
    pub ignore: Vec<Spanned<String>>,
    pub joints: Vec<DeclaredJoint>,
    /// Other limits.
    pub limits: Vec<(Spanned<String>, DeclaredLimit)>,
}

/// Reads a file or a part of it, without profiles, and reports every problem.
pub(super) fn read(root: &Node, source: &SourceText, problems: &mut Vec<Diagnostic>) -> LimitsFile {
    let mut reader = Reader { source, problems };
    let mut file = LimitsFile::default();
    for (key, node) in reader.map(root, "the file", &FILE_KEYS) {
        let name = key.value.as_str();
        match name {
            "robot" => file.robot = reader.text(name, node),
            "model" => file.model = reader.text(name, node),
            "severity" => file.severity = reader.severity(node),
            "factor" => file.factor = reader.factor(node),
            "signals" => file.templates = reader.templates(node),
            "ignore" => file.ignore = reader.names(name, node),
            "joints" => file.joints = reader.joints(node),
            "limits" => {
                for (name, node) in reader.names_to_values(name, node) {
                    let limit = reader.limit(name, node, &LIMIT_KEYS);
                    file.limits.push((name.clone(), limit));
                }
            }
            _ => {}
        }
    }
    file
}

struct Reader<'a> {
    source: &'a SourceText,
    problems: &'a mut Vec<Diagnostic>,
}

impl Reader<'_> {
    fn report(&mut self, code: &str, span: Span, message: String) {
        self.problems.push(self.source.error(code, span, message));
    }

    fn wrong(&mut self, name: &str, node: &Node, expected: &str) {
        let found = match &node.value {
            Value::Text(text) => format!("`{text}`"),
            _ => node.kind().to_owned(),
        };
        self.report(
            "invalid-value",
            node.span,
            format!("`{name}` is {found}, expected {expected}"),
        );
    }

    /// The entries of a mapping; `null` is an empty one.
    fn names_to_values<'n>(&mut self, name: &str, node: &'n Node) -> &'n [(Spanned<String>, Node)] {
        if !matches!(node.value, Value::Map(_) | Value::Null) {
            self.wrong(name, node, "a mapping");
        }
        node.entries()
    }

    /// The entries with known keys and a value.
    fn map<'n>(
        &mut self,
        node: &'n Node,
        name: &str,
        keys: &[&'static str],
    ) -> Vec<&'n (Spanned<String>, Node)> {
        let mut known = Vec::new();
        for entry in self.names_to_values(name, node) {
            let (key, value) = entry;
            if keys.contains(&key.value.as_str()) {
                if !matches!(value.value, Value::Null) {
                    known.push(entry);
                }
                continue;
            }
            let message = format!("unknown key `{}`", key.value);
            let label = self.source.label(key.span, format!("not known in {name}"));
            let problem = Diagnostic::error("unknown-key", message).label(label);
            let list = quoted(keys.iter().copied(), ", ");
            let problem = problem.note(format!("the keys are {list}"));
            self.problems.push(suggest(problem, &key.value, keys.iter().copied()));
        }
        known
    }

    /// Reads a text that `parse` accepts, and reports another value.
    fn parsed<T>(
        &mut self,
        name: &str,
        node: &Node,
        parse: impl FnOnce(&str) -> Option<T>,
        expected: &str,
    ) -> Option<T> {
        let value = match &node.value {
            Value::Text(text) => parse(text),
            _ => None,
        };
        if value.is_none() {
            self.wrong(name, node, expected);
        }
        value
    }

    fn text(&mut self, name: &str, node: &Node) -> Option<Spanned<String>> {
        let parse = |text: &str| is_name(text).then(|| Spanned::new(text.to_owned(), node.span));
        self.parsed(name, node, parse, "a text without control characters")
    }

    fn names(&mut self, name: &str, node: &Node) -> Vec<Spanned<String>> {
        let Value::List(items) = &node.value else {
            self.wrong(name, node, "a list of names");
            return Vec::new();
        };
        items.iter().filter_map(|item| self.text(name, item)).collect()
    }

    fn severity(&mut self, node: &Node) -> Option<FindingSeverity> {
        let words = quoted(FindingSeverity::ALL.iter().map(|(word, _)| *word), ", ");
        let parse = |text: &str| {
            let found = FindingSeverity::ALL.into_iter().find(|(word, _)| *word == text);
            found.map(|(_, severity)| severity)
        };
        self.parsed("severity", node, parse, &format!("one of {words}"))
    }

    fn factor(&mut self, node: &Node) -> Option<f64> {
        let parse = |text: &str| text.parse().ok().filter(|it| *it > 0.0 && *it <= 1.0);
        self.parsed("factor", node, parse, "a number above 0, at most 1")
    }

    fn templates(&mut self, node: &Node) -> Vec<Template> {
        let mut templates = Vec::new();
        for quantity in Quantity::ALL {
            let name = quantity.name();
            let Some((_, value)) = node.entries().iter().find(|(key, _)| key.value == name) else {
                continue;
            };
            let Some(text) = self.text(name, value) else { continue };
            let is_rate = text.value == RATE && quantity.integral().is_some();
            if !is_rate && !text.value.contains(JOINT) {
                self.wrong(name, value, "the name of a signal with `{joint}`");
                continue;
            }
            templates.push(Template { quantity, text });
        }
        self.map(node, "signals", &Quantity::ALL.map(Quantity::name));
        templates
    }

    fn joints(&mut self, node: &Node) -> Vec<DeclaredJoint> {
        let mut joints = Vec::new();
        for (name, node) in self.names_to_values("joints", node) {
            let known = Quantity::ALL.map(Quantity::name);
            let mut limits = Vec::new();
            for (key, node) in self.map(node, "a joint", &known) {
                let all = Quantity::ALL.into_iter();
                let quantity = all.into_iter().find(|quantity| quantity.name() == key.value);
                let Some(quantity) = quantity else { continue };
                let keys = if quantity.is_magnitude() { &MAGNITUDE_KEYS[..] } else { &LIMIT_KEYS };
                limits.push((quantity, self.limit(key, node, keys)));
            }
            joints.push(DeclaredJoint { name: name.clone(), limits });
        }
        joints
    }

    fn limit(
        &mut self,
        key: &Spanned<String>,
        node: &Node,
        keys: &[&'static str],
    ) -> DeclaredLimit {
        let mut limit = DeclaredLimit { span: key.span, ..DeclaredLimit::default() };
        for (key, node) in self.map(node, &format!("the limit `{}`", key.value), keys) {
            let name = key.value.as_str();
            match name {
                "signal" | "rate-of" => {
                    if limit.input.is_some() {
                        let message = "a limit has `signal` or `rate-of`, not both".to_owned();
                        self.report("conflicting-keys", key.span, message);
                    }
                    let kind = if name == "signal" { Input::Signal } else { Input::RateOf };
                    limit.input = self.text(name, node).map(kind);
                }
                "min" => limit.bounds.min = self.bound(name, node),
                "max" => limit.bounds.max = self.bound(name, node),
                "for" => {
                    let parse = |text: &str| parse_duration(text).ok();
                    limit.tolerated = self.parsed(name, node, parse, "a duration such as `80ms`");
                }
                _ => limit.severity = self.severity(node),
            }
        }
        limit
    }

    fn bound(&mut self, name: &str, node: &Node) -> Option<Bound> {
        let parse = |text: &str| Bound::parse(text, node.span);
        self.parsed(name, node, parse, "a number, with or without a unit: `1.05rad`")
    }
}

fn is_name(text: &str) -> bool {
    !text.trim().is_empty() && !text.contains(char::is_control)
}
