//! Checks units, and converts the operands of comparisons, sums, `min` and `max` to one unit.

use super::{Unit, UnitError};
use crate::syntax::{Arithmetic, Condition, Number};

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
                self.unify(sides.as_mut_slice());
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

    /// Converts the parts of a number, and returns its unit.
    fn number(&mut self, number: &mut Number) -> Quantity {
        match number {
            Number::Literal { unit, .. } => match unit.take() {
                Some(unit) => Quantity::Known(Unit::parse(&unit)),
                None => Quantity::Constant,
            },
            Number::Signal { index, .. } | Number::Hold { index, .. } => {
                let unit = self.units.get(*index).cloned().flatten();
                unit.map_or(Quantity::Unknown, Quantity::Known)
            }
            Number::Rate { inner, .. } => match self.number(inner) {
                Quantity::Known(unit) => Quantity::Known(unit.times(&Unit::parse("s"), -1)),
                Quantity::Constant => Quantity::Known(Unit::parse("1/s")),
                Quantity::Unknown => Quantity::Unknown,
            },
            Number::Negative { inner, .. } | Number::Absolute { inner, .. } => self.number(inner),
            Number::Extreme { parts, .. } => self.unify(parts),
            Number::Operation { operation, sides, .. } => match operation {
                Arithmetic::Add | Arithmetic::Subtract => self.unify(sides.as_mut_slice()),
                Arithmetic::Multiply | Arithmetic::Divide => {
                    let exponent = if *operation == Arithmetic::Multiply { 1 } else { -1 };
                    let [left, right] = sides.each_mut().map(|side| self.number(side));
                    product(&left, &right, exponent)
                }
            },
        }
    }

    /// Converts all to the unit of the first that has a signal, or of the first with a unit.
    fn unify(&mut self, numbers: &mut [Number]) -> Quantity {
        let quantities: Vec<_> = numbers.iter_mut().map(|number| self.number(number)).collect();
        let known = || {
            let parts = numbers.iter().zip(&quantities);
            parts.filter_map(|(number, quantity)| match quantity {
                Quantity::Known(unit) => Some((number, unit)),
                Quantity::Constant | Quantity::Unknown => None,
            })
        };
        let with_signal = known().find(|(number, _)| has_signal(number));
        let target = with_signal.or_else(|| known().next()).map(|(_, unit)| unit.clone());
        let is_unknown = quantities.iter().any(|it| matches!(it, Quantity::Unknown));
        let Some(target) = target else {
            return if is_unknown { Quantity::Unknown } else { Quantity::Constant };
        };
        for (number, quantity) in numbers.iter_mut().zip(&quantities) {
            let Quantity::Known(unit) = quantity else { continue };
            if is_unknown && !has_signal(number) {
                self.errors.push(UnitError {
                    range: number.span(),
                    message: format!(
                        "`{}` cannot be converted: the unit of the signal is not known",
                        unit.text
                    ),
                    hint: Some(
                        "declare the unit of the signal, or write the constant without one".into(),
                    ),
                });
            } else if unit.is_compatible(&target) {
                scale(number, unit.scale / target.scale);
            } else {
                let message =
                    format!("the units do not match: {} and {}", name(&target), name(unit));
                self.errors.push(UnitError { range: number.span(), message, hint: None });
            }
        }
        if is_unknown { Quantity::Unknown } else { Quantity::Known(target) }
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
