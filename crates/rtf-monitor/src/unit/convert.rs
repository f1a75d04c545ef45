//! Checks units, and converts the operands of comparisons, sums, `min` and `max` to one unit.

use super::{Unit, UnitError};
use crate::syntax::{Arithmetic, Condition, Number, Span};

/// The unit of an expression.
#[derive(Clone, Debug)]
enum Quantity {
    /// A constant without a unit, which takes the unit of what it is compared with or added to.
    Constant,
    /// The unit of one of its signals is not known.
    Unknown,
    /// That of a pure number is empty.
    Known(Unit),
}

/// An expression with its unit.
struct Converted {
    number: Number,
    quantity: Quantity,
}

/// Converts a condition. `units` has the unit of each signal.
///
/// # Errors
/// All places where units do not match.
pub(crate) fn convert(
    condition: &Condition,
    units: &[Option<String>],
) -> Result<Condition, Vec<UnitError>> {
    let units = units.iter().map(|unit| unit.as_deref().map(Unit::parse)).collect();
    let mut converter = Converter { units, errors: Vec::new() };
    let mut converted = condition.clone();
    converter.condition(&mut converted);
    if converter.errors.is_empty() { Ok(converted) } else { Err(converter.errors) }
}

struct Converter {
    units: Vec<Option<Unit>>,
    errors: Vec<UnitError>,
}

impl Converter {
    fn condition(&mut self, condition: &mut Condition) {
        match condition {
            Condition::Comparison { sides, .. } => {
                let [left, right] = sides.as_ref();
                let mut parts = vec![self.number(left), self.number(right)];
                self.unify(&mut parts);
                let mut numbers = parts.into_iter().map(|part| part.number);
                if let (Some(left), Some(right)) = (numbers.next(), numbers.next()) {
                    **sides = [left, right];
                }
            }
            Condition::Constant(..) | Condition::Truth { .. } => {}
            Condition::Not(inner, _)
            | Condition::Window { inner, .. }
            | Condition::Edge { inner, .. } => self.condition(inner),
            Condition::Junction { parts, .. } => {
                for part in parts {
                    self.condition(part);
                }
            }
            Condition::UpTo { sides, .. } => {
                for side in sides.iter_mut() {
                    self.condition(side);
                }
            }
        }
    }

    fn number(&mut self, number: &Number) -> Converted {
        match number {
            Number::Literal { value, unit, span } => {
                let quantity = unit
                    .as_deref()
                    .map_or(Quantity::Constant, |unit| Quantity::Known(Unit::parse(unit)));
                let number = Number::Literal { value: *value, unit: None, span: span.clone() };
                Converted { number, quantity }
            }
            Number::Signal { index, .. } | Number::Hold { index, .. } => {
                let unit = self.units.get(*index).cloned().flatten();
                let quantity = unit.map_or(Quantity::Unknown, Quantity::Known);
                Converted { number: number.clone(), quantity }
            }
            Number::Rate { inner, span } => {
                let inner = self.number(inner);
                let quantity = match inner.quantity {
                    Quantity::Known(unit) => Quantity::Known(unit.times(&Unit::parse("s"), -1)),
                    Quantity::Constant => Quantity::Known(Unit::parse("1/s")),
                    Quantity::Unknown => Quantity::Unknown,
                };
                let number = Number::Rate { inner: Box::new(inner.number), span: span.clone() };
                Converted { number, quantity }
            }
            Number::Negative { inner, span } => {
                let Converted { number, quantity } = self.number(inner);
                let number = Number::Negative { inner: Box::new(number), span: span.clone() };
                Converted { number, quantity }
            }
            Number::Absolute { inner, span } => {
                let Converted { number, quantity } = self.number(inner);
                let number = Number::Absolute { inner: Box::new(number), span: span.clone() };
                Converted { number, quantity }
            }
            Number::Extreme { which, parts, span } => {
                let mut parts: Vec<_> = parts.iter().map(|part| self.number(part)).collect();
                let quantity = self.unify(&mut parts);
                let parts = parts.into_iter().map(|part| part.number).collect();
                Converted {
                    number: Number::Extreme { which: *which, parts, span: span.clone() },
                    quantity,
                }
            }
            Number::Operation { operation, sides, span } => self.operation(*operation, sides, span),
        }
    }

    fn operation(&mut self, operation: Arithmetic, sides: &[Number; 2], span: &Span) -> Converted {
        let mut left = self.number(&sides[0]);
        let mut right = self.number(&sides[1]);
        let quantity = if let Arithmetic::Add | Arithmetic::Subtract = operation {
            let mut parts = vec![left, right];
            let quantity = self.unify(&mut parts);
            right = parts.swap_remove(1);
            left = parts.swap_remove(0);
            quantity
        } else {
            let exponent = if operation == Arithmetic::Multiply { 1 } else { -1 };
            product(&left.quantity, &right.quantity, exponent)
        };
        let sides = Box::new([left.number, right.number]);
        Converted { number: Number::Operation { operation, sides, span: span.clone() }, quantity }
    }

    /// Converts all to the unit of the first that has a signal, or of the first with a unit.
    fn unify(&mut self, parts: &mut [Converted]) -> Quantity {
        let is_known = |part: &&Converted| matches!(part.quantity, Quantity::Known(_));
        let target = parts
            .iter()
            .filter(is_known)
            .find(|part| has_signal(&part.number))
            .or_else(|| parts.iter().find(is_known));
        let Some((target, place)) = target.and_then(|target| match &target.quantity {
            Quantity::Known(unit) => Some((unit.clone(), target.number.span())),
            _ => None,
        }) else {
            let unknown = parts.iter().any(|part| matches!(part.quantity, Quantity::Unknown));
            return if unknown { Quantity::Unknown } else { Quantity::Constant };
        };
        let unknown = parts.iter().find(|part| matches!(part.quantity, Quantity::Unknown));
        let unknown = unknown.map(|part| part.number.span());
        for part in parts.iter_mut() {
            let Quantity::Known(unit) = &part.quantity else { continue };
            if unknown.is_some() && !has_signal(&part.number) {
                self.errors.push(UnitError {
                    range: part.number.span(),
                    message: format!(
                        "`{}` cannot be converted: the unit of the signal is not known",
                        unit.text
                    ),
                    hint: Some(
                        "declare the unit of the signal, or write the constant without one".into(),
                    ),
                });
            } else if unit.is_compatible(&target) {
                scale(&mut part.number, unit.scale / target.scale);
            } else {
                let message =
                    format!("the units do not match: {} and {}", name(&target), name(unit));
                let earlier = place == part.number.span();
                let range = if earlier { place.clone() } else { part.number.span() };
                self.errors.push(UnitError { range, message, hint: None });
            }
        }
        if unknown.is_some() { Quantity::Unknown } else { Quantity::Known(target) }
    }
}

/// A unit in a message.
fn name(unit: &Unit) -> String {
    if unit.text.is_empty() { "a pure number".into() } else { format!("`{}`", unit.text) }
}

fn has_signal(number: &Number) -> bool {
    number.contains(&|part| matches!(part, Number::Signal { .. } | Number::Hold { .. }))
}

/// The unit of a product or, with the exponent -1, a quotient.
fn product(left: &Quantity, right: &Quantity, exponent: i32) -> Quantity {
    match (left, right) {
        (Quantity::Unknown, _) | (_, Quantity::Unknown) => Quantity::Unknown,
        (Quantity::Constant, Quantity::Constant) => Quantity::Constant,
        (left, Quantity::Constant) => left.clone(),
        (Quantity::Constant, Quantity::Known(unit)) => {
            Quantity::Known(Unit::parse("").times(unit, exponent))
        }
        (Quantity::Known(left), Quantity::Known(right)) => {
            Quantity::Known(left.times(right, exponent))
        }
    }
}

#[expect(clippy::float_cmp, reason = "a factor of exactly 1 changes nothing")]
fn scale(number: &mut Number, factor: f64) {
    if factor == 1.0 {
        return;
    }
    if let Number::Literal { value, .. } = number {
        *value *= factor;
        return;
    }
    let span = number.span();
    let literal = Number::Literal { value: factor, unit: None, span: span.clone() };
    let sides = Box::new([number.clone(), literal]);
    *number = Number::Operation { operation: Arithmetic::Multiply, sides, span };
}
