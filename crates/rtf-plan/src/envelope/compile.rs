//! A file of limits → monitors.

use std::time::Duration;

use rtf_model::{Diagnostic, FindingSeverity, Location, Severity};
use rtf_monitor::Formula;

use super::bound::{Bound, Bounds};
use super::file::{DeclaredJoint, JOINT, LimitsFile, RATE};
use super::joint::ModelJoint;
use super::limit::{DeclaredLimit, Input, Quantity};
use super::model::Model;
use super::{CompiledEnvelope, EnvelopeMonitor, EnvelopeRequest};
use crate::suite::{SourceText, Span, Spanned};
use crate::wording::{quoted, suggest, suggest_or};

/// Compiles a file of limits.
pub(super) struct Compiler<'a> {
    pub request: &'a EnvelopeRequest<'a>,
    pub source: &'a SourceText,
    pub file: &'a LimitsFile,
    pub model: Option<&'a Model>,
}

/// A limit with everything that its formula contains.
struct Limit {
    name: String,
    input: Input,
    is_magnitude: bool,
    bounds: Bounds,
    tolerated: Option<Duration>,
    severity: FindingSeverity,
    /// The position in the file; `None` for a limit of the model.
    span: Option<Span>,
    location: Location,
    column: u32,
}

impl Compiler<'_> {
    /// Adds the monitors and problems of the file.
    pub fn run(&self, compiled: &mut CompiledEnvelope) {
        let problems = &mut compiled.problems;
        self.report_unknown_joints(problems);
        let mut limits = Vec::new();
        for joint in &self.file.joints {
            let of_model = self.model_joint(&joint.name.value);
            limits.extend(self.joint(&joint.name.value, Some(joint), of_model, problems));
        }
        for joint in self.model.iter().flat_map(|model| &model.joints) {
            let is_named = |name: &&Spanned<String>| name.value == joint.name;
            let declared = self.file.joints.iter().any(|it| is_named(&&it.name));
            if !declared && !self.file.ignore.iter().any(|name| is_named(&name)) {
                limits.extend(self.joint(&joint.name, None, Some(joint), problems));
            }
        }
        for (name, limit) in &self.file.limits {
            limits.extend(self.other(name, limit, problems));
        }
        let mut monitors = Vec::new();
        for limit in &limits {
            self.check(limit, problems);
            monitors.push(self.monitor(limit));
        }
        let has_errors = problems.iter().any(|problem| problem.severity == Severity::Error);
        if monitors.is_empty() && !has_errors {
            let message = format!("`{}` limits nothing", self.source.name());
            let hint = "write limits, or `model` and `signals`";
            problems.push(self.source.error("incomplete", Span::new(0..0), message).hint(hint));
        }
        compiled.monitors = monitors;
    }

    fn model_joint(&self, name: &str) -> Option<&ModelJoint> {
        self.model?.joints.iter().find(|joint| joint.name == name)
    }

    fn report_unknown_joints(&self, problems: &mut Vec<Diagnostic>) {
        let Some(model) = self.model else { return };
        let joints = self.file.joints.iter().map(|joint| &joint.name);
        for name in joints.chain(&self.file.ignore) {
            if self.model_joint(&name.value).is_some() {
                continue;
            }
            let known = || model.joints.iter().map(|joint| joint.name.as_str());
            let message = format!("`{}` has no joint `{}` that moves", model.file, name.value);
            let problem = self
                .source
                .error("unknown-joint", name.span, message)
                .note(format!("its joints are {}", quoted(known(), ", ")));
            problems.push(suggest(problem, &name.value, known()));
        }
    }

    fn joint(
        &self,
        name: &str,
        declared: Option<&DeclaredJoint>,
        of_model: Option<&ModelJoint>,
        problems: &mut Vec<Diagnostic>,
    ) -> Vec<Limit> {
        let mut limits = Vec::new();
        for quantity in Quantity::ALL {
            let find = |(known, _): &&(Quantity, DeclaredLimit)| *known == quantity;
            let own = declared.and_then(|joint| joint.limits.iter().find(find));
            let own = own.map(|(_, limit)| limit);
            let of_model = of_model.and_then(|joint| {
                let (_, bounds) = joint.limits.iter().find(|(known, _)| *known == quantity)?;
                Some((joint, bounds))
            });
            let input = own.and_then(|limit| limit.input.clone());
            let input = input.or_else(|| self.template(name, quantity));
            let (own, input) = match (own, input) {
                (own, Some(input)) if own.is_some() || of_model.is_some() => (own, input),
                (Some(own), _) => {
                    let hint = format!("write `signal: …`, or `{}` in `signals`", quantity.name());
                    self.incomplete(own.span, "a signal", &hint, problems);
                    continue;
                }
                _ => continue,
            };
            let bounds = self.merged(own, of_model, problems);
            if bounds == Bounds::default() {
                if let Some(own) = own {
                    self.incomplete(own.span, "a value", "write `max: …`", problems);
                }
                continue;
            }
            let name = format!("{name} {}", quantity.name());
            let magnitude = quantity.is_magnitude();
            limits.push(self.limit((name, input, magnitude), bounds, own, of_model));
        }
        limits
    }

    fn other(
        &self,
        name: &Spanned<String>,
        declared: &DeclaredLimit,
        problems: &mut Vec<Diagnostic>,
    ) -> Option<Limit> {
        let Some(input) = declared.input.clone() else {
            self.incomplete(declared.span, "a signal", "write `signal: …`", problems);
            return None;
        };
        if declared.bounds == Bounds::default() {
            let hint = "write `min: …`, `max: …`, or both";
            self.incomplete(declared.span, "a value", hint, problems);
            return None;
        }
        let bounds = self.merged(Some(declared), None, problems);
        Some(self.limit((name.value.clone(), input, false), bounds, Some(declared), None))
    }

    fn incomplete(&self, span: Span, what: &str, hint: &str, problems: &mut Vec<Diagnostic>) {
        let message = format!("the limit needs {what}");
        problems.push(self.source.error("incomplete", span, message).hint(hint));
    }

    /// The signal that the file names for all joints.
    fn template(&self, joint: &str, quantity: Quantity) -> Option<Input> {
        let template = self.file.templates.iter().find(|it| it.quantity == quantity)?;
        if template.text.value == RATE {
            let integral = self.template(joint, quantity.integral()?)?;
            // The rate of a rate does not exist; the text is reported as an unknown signal.
            return match integral {
                Input::Signal(name) => Some(Input::RateOf(name)),
                Input::RateOf(_) => Some(Input::Signal(template.text.clone())),
            };
        }
        let name = template.text.value.replace(JOINT, joint);
        Some(Input::Signal(Spanned::new(name, template.text.span)))
    }

    /// The sides of the file, else of the model; warns about sides that permit more.
    fn merged(
        &self,
        own: Option<&DeclaredLimit>,
        of_model: Option<(&ModelJoint, &Bounds)>,
        problems: &mut Vec<Diagnostic>,
    ) -> Bounds {
        let own = own.map(|limit| limit.bounds.clone()).unwrap_or_default();
        let Some((joint, bounds)) = of_model else { return own };
        let sides = [(&own.min, &bounds.min, -1.0), (&own.max, &bounds.max, 1.0)];
        for (own, of_model, sign) in sides {
            let (Some(own), Some(of_model)) = (own, of_model) else { continue };
            let is_same_unit = own.unit.is_empty() || own.unit == of_model.unit;
            if is_same_unit && own.value * sign > of_model.value * sign {
                let model = self.model.map_or("", |model| &model.file);
                let (line, column) = joint.at;
                let message = format!(
                    "the limit permits more than the model: {} at {model}:{line}:{column}",
                    of_model.constant()
                );
                let problem = Diagnostic::warning("exceeds-model", message);
                let label = own.span.map(|span| self.source.label(span, ""));
                problems.push(label.into_iter().fold(problem, Diagnostic::label));
            }
        }
        Bounds { min: own.min.or(bounds.min.clone()), max: own.max.or(bounds.max.clone()) }
    }

    fn limit(
        &self,
        (name, input, is_magnitude): (String, Input, bool),
        bounds: Bounds,
        own: Option<&DeclaredLimit>,
        of_model: Option<(&ModelJoint, &Bounds)>,
    ) -> Limit {
        let own_position = own.map(|limit| {
            let label = self.source.label(limit.span, "");
            (label.file, label.line, label.column)
        });
        let model_position = || {
            let (line, column) = of_model?.0.at;
            Some((self.model?.file.clone(), line, column))
        };
        let (file, line, column) = own_position.or_else(model_position).unwrap_or_default();
        let name = match &self.file.robot {
            Some(robot) => format!("{}: {name}", robot.value),
            None => name,
        };
        let severity = own.and_then(|limit| limit.severity).or(self.file.severity);
        Limit {
            name,
            input,
            is_magnitude,
            bounds,
            tolerated: own.and_then(|limit| limit.tolerated).filter(|it| !it.is_zero()),
            severity: severity.unwrap_or(FindingSeverity::Fail),
            span: own.map(|limit| limit.span),
            location: Location { file, line },
            column,
        }
    }

    /// Reports an unknown signal, units that do not match, and an empty range.
    fn check(&self, limit: &Limit, problems: &mut Vec<Diagnostic>) {
        let signal = limit.input.signal();
        let Some(declared) = self.request.signals.iter().find(|it| it.name.value == signal.value)
        else {
            let message = format!("there is no signal `{}`", signal.value);
            let problem = self.source.error("unknown-signal", signal.span, message);
            if limit.span.is_none() {
                let hint =
                    "declare it with `<signal>` in the suite, or write its joint in `ignore`";
                problems.push(problem.hint(hint));
                return;
            }
            let known = self.request.signals.iter().map(|signal| signal.name.value.as_str());
            problems.push(suggest_or(problem, &signal.value, known, |problem| {
                problem.hint("declare it with `<signal>` in the suite")
            }));
            return;
        };
        let before = problems.len();
        for bound in limit.bounds.min.iter().chain(&limit.bounds.max) {
            self.check_unit(limit, bound, &declared.unit.value, problems);
        }
        let (Some(min), Some(max)) = (&limit.bounds.min, &limit.bounds.max) else { return };
        if problems.len() > before {
            return;
        }
        let at = max.span.or(min.span).or(limit.span).unwrap_or(signal.span);
        if min.unit != max.unit {
            if self.file.factor.is_some_and(|factor| factor < 1.0) {
                let message = "`factor` needs the same unit for `min` and `max`";
                problems.push(self.source.error("unit-mismatch", at, message));
            }
        } else if min.value > max.value {
            let message = format!("`min` is above `max`: {} > {}", min.constant(), max.constant());
            problems.push(self.source.error("empty-range", at, message));
        }
    }

    fn check_unit(&self, limit: &Limit, bound: &Bound, unit: &str, problems: &mut Vec<Diagnostic>) {
        let operand = operand(limit);
        let text = format!("{operand} <= {}", bound.constant());
        let at = bound.span.unwrap_or_else(|| limit.input.signal().span);
        let (message, hint) = match Formula::parse(&text) {
            Ok(formula) => match formula.check_units(&|_| Some(unit.to_owned())) {
                Ok(_) => return,
                Err(mut errors) => {
                    let Some(error) = errors.pop() else { return };
                    (error.message, error.hint)
                }
            },
            Err(error) => (error.message, error.hint),
        };
        let message = format!("`{}`: {message}", limit.name);
        let problem = Diagnostic::error("unit-mismatch", message);
        let problem = problem.label(self.source.label(at, ""));
        let problem = Diagnostic { hint, ..problem };
        if !problems.contains(&problem) {
            problems.push(problem);
        }
    }

    fn monitor(&self, limit: &Limit) -> EnvelopeMonitor {
        let bounds = limit.bounds.tightened(self.file.factor.unwrap_or(1.0));
        EnvelopeMonitor {
            name: limit.name.clone(),
            formula: formula(limit, &bounds),
            severity: limit.severity,
            origin: format!("{}:{}", limit.location, limit.column),
            location: limit.location.clone(),
        }
    }
}

/// The side of the comparisons with the signal.
fn operand(limit: &Limit) -> String {
    let signal = reference(&limit.input.signal().value);
    let value = match &limit.input {
        Input::Signal(_) => signal,
        Input::RateOf(_) => format!("rate({signal})"),
    };
    if limit.is_magnitude { format!("abs({value})") } else { value }
}

fn formula(limit: &Limit, bounds: &Bounds) -> String {
    let operand = operand(limit);
    let min = bounds.min.as_ref().map(|min| format!("{operand} >= {}", min.constant()));
    let max = bounds.max.as_ref().map(|max| format!("{operand} <= {}", max.constant()));
    let inside: Vec<_> = min.into_iter().chain(max).collect();
    let inside = inside.join(" and ");
    match limit.tolerated {
        None => format!("always({inside})"),
        Some(tolerated) => {
            let micros = tolerated.as_micros();
            let duration = match micros % 1000 {
                0 => format!("{}ms", micros / 1000),
                _ => format!("{micros}us"),
            };
            format!("always(not({inside}) -> eventually[0,{duration}] ({inside}))")
        }
    }
}

/// A signal in a formula; in quotes unless it is a word.
fn reference(name: &str) -> String {
    let is_word = Formula::parse(name)
        .is_ok_and(|formula| matches!(formula.signals(), [signal] if signal.name == name));
    if is_word { name.to_owned() } else { format!("\"{name}\"") }
}
