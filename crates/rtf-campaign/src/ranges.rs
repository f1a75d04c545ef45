//! The values that the parameters of a campaign can have.

use rtf_model::Parameter;
use serde::Serialize;

use crate::Campaign;
use crate::episodes::Resolution;
use crate::episodes::sampler::{number_of, text_of};
use crate::episodes::space::table;
use crate::file::{DeclaredParameter, Distribution};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterRange {
    pub name: String,
    /// Of words, each once, in the order of the file.
    #[serde(flatten)]
    pub values: Distribution,
    pub nominal: String,
}

impl ParameterRange {
    /// Whether the values are any numbers in a range.
    #[must_use]
    pub fn is_real(&self) -> bool {
        !matches!(self.values, Distribution::Choice { .. })
    }
}

/// Returns all parameters, in the order of their values in an episode. `None` if a file cannot be
/// read, which is reported.
#[must_use]
pub fn ranges(campaign: &Campaign, resolution: &mut Resolution<'_>) -> Option<Vec<ParameterRange>> {
    let mut ranges = Vec::new();
    for parameter in &campaign.parameters {
        match parameter {
            DeclaredParameter::Grid { name, values, nominal } => {
                ranges.push(of_words(&name.value, values, nominal.as_ref()));
            }
            DeclaredParameter::File(file) => {
                let table = table(file, resolution)?;
                for (column, name) in table.names.iter().enumerate() {
                    let words = table.rows.iter().filter_map(|row| row.get(column).cloned());
                    ranges.push(of_words(name, &words.collect::<Vec<_>>(), None));
                }
            }
            DeclaredParameter::Sampled { name, distribution, nominal, .. } => {
                ranges.push(of_distribution(&name.value, distribution, nominal.as_ref()));
            }
        }
    }
    Some(ranges)
}

fn of_words(name: &str, words: &[String], nominal: Option<&String>) -> ParameterRange {
    let mut values: Vec<String> = Vec::new();
    for word in words {
        if !values.contains(word) {
            values.push(word.clone());
        }
    }
    let nominal = nominal.or(words.first()).cloned().unwrap_or_default();
    ParameterRange { name: name.to_owned(), values: Distribution::Choice { values }, nominal }
}

fn of_distribution(
    name: &str,
    distribution: &Distribution,
    nominal: Option<&String>,
) -> ParameterRange {
    let middle = match distribution {
        Distribution::Choice { values } => return of_words(name, values, nominal),
        Distribution::Uniform { low, high } => low + (high - low) / 2.0,
        Distribution::Normal { mean, .. } => *mean,
    };
    let nominal = nominal.cloned().unwrap_or_else(|| text_of(middle));
    ParameterRange { name: name.to_owned(), values: distribution.clone(), nominal }
}

#[must_use]
pub fn meet_constraints(campaign: &Campaign, parameters: &[Parameter]) -> bool {
    let mut number = |name: &str| {
        let parameter = parameters.iter().find(|parameter| parameter.name == name);
        parameter.and_then(|parameter| number_of(&parameter.value)).unwrap_or(f64::NAN)
    };
    campaign.constraints.iter().all(|constraint| constraint.holds(&mut number))
}

/// The text of a number as a value of a parameter; `None` if it is not finite.
#[must_use]
pub fn value_of(number: f64) -> Option<String> {
    number.is_finite().then(|| text_of(number))
}
