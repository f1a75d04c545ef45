//! All parameters of a campaign, and their values for a candidate.

use rtf_model::Diagnostic;
use rtf_plan::config::{describe_same_variable, variable};
use rtf_plan::plan::matrix_file::{MatrixTable, read_table};
use rtf_plan::suite::{Span, Spanned};

use super::sampler::{Sampler, Value, number_of};
use super::sobol::DIMENSIONS;
use super::{Resolution, report_size};
use crate::Campaign;
use crate::file::{DeclaredParameter, Distribution};

/// The most combinations of grids and files.
pub(super) const MAX_COMBINATIONS: u64 = 1_000_000;

/// The parameters, in the order of the file.
pub(super) struct Space<'a> {
    dimensions: Vec<Dimension<'a>>,
    pub names: Vec<String>,
    /// The number of combinations of grids and files; 1 without.
    pub combinations: u64,
}

/// An element `<parameter>`.
enum Dimension<'a> {
    /// The rows of values of a grid or a file.
    Table(MatrixTable),
    Sampler(Box<Sampler<'a>>),
}

impl<'a> Space<'a> {
    /// Reads the files and checks the names. `None` if there is an error, which is reported.
    pub fn new(campaign: &'a Campaign, resolution: &mut Resolution<'_>) -> Option<Self> {
        let before = resolution.problems.len();
        let mut sobol_dimensions = 0;
        let mut dimensions = Vec::new();
        let mut names: Vec<(String, Span)> = Vec::new();
        for parameter in &campaign.parameters {
            let dimension = match parameter {
                DeclaredParameter::Grid { name, values, .. } => {
                    let rows = values.iter().map(|value| vec![value.clone()]).collect();
                    Dimension::Table(MatrixTable { names: vec![name.value.clone()], rows })
                }
                DeclaredParameter::File(file) => match table(file, resolution) {
                    Some(table) => Dimension::Table(table),
                    None => continue,
                },
                DeclaredParameter::Sampled { name, design, distribution, .. } => {
                    let of = (name.value.as_str(), *design, distribution);
                    let campaign = (campaign.seed, campaign.episodes.unwrap_or(1));
                    let Some(sampler) = Sampler::new(of, campaign, &mut sobol_dimensions) else {
                        let message = format!("more than {DIMENSIONS} parameters are `sobol`");
                        resolution.report(resolution.source.error(
                            "invalid-value",
                            name.span,
                            message,
                        ));
                        continue;
                    };
                    names.push((name.value.clone(), name.span));
                    Dimension::Sampler(Box::new(sampler))
                }
            };
            if let Dimension::Table(table) = &dimension {
                names.extend(table.names.iter().map(|name| (name.clone(), parameter.span())));
            }
            dimensions.push(dimension);
        }
        if resolution.problems.len() > before {
            return None;
        }
        let version = campaign.versions().map(|versions| &versions.parameter);
        let version = version.map(|name| (name.value.clone(), name.span));
        check_names(&names.iter().cloned().chain(version).collect::<Vec<_>>(), resolution);
        check_constraints(campaign, &names, &dimensions, resolution);
        let combinations = combinations(&dimensions);
        if combinations > MAX_COMBINATIONS {
            report_size(campaign, resolution);
        }
        let names = names.into_iter().map(|(name, _)| name).collect();
        (resolution.problems.len() == before).then_some(Self { dimensions, names, combinations })
    }

    /// Returns the values of all parameters.
    pub fn candidate(&mut self, candidate: u64) -> Vec<Value> {
        let mut values = Vec::with_capacity(self.names.len());
        // How many combinations the remaining tables have: the last one varies fastest.
        let mut remaining = self.combinations;
        let mut combination = candidate % self.combinations.max(1);
        for dimension in &mut self.dimensions {
            match dimension {
                Dimension::Sampler(sampler) => values.push(sampler.value(candidate)),
                Dimension::Table(table) => {
                    remaining /= (table.rows.len() as u64).max(1);
                    let row = usize::try_from(combination / remaining.max(1)).unwrap_or(usize::MAX);
                    combination %= remaining.max(1);
                    let row = table.rows.get(row).into_iter().flatten();
                    values.extend(row.map(|word| (word.clone(), number_of(word))));
                }
            }
        }
        values
    }

    /// Whether values meet the constraints.
    pub fn allows(&self, campaign: &Campaign, values: &[Value]) -> bool {
        let mut number = |name: &str| {
            let index = self.names.iter().position(|known| known == name);
            index.and_then(|index| values[index].1).unwrap_or(f64::NAN)
        };
        campaign.constraints.iter().all(|constraint| constraint.holds(&mut number))
    }
}

fn combinations(dimensions: &[Dimension<'_>]) -> u64 {
    dimensions.iter().fold(1, |product: u64, dimension| match dimension {
        Dimension::Table(table) => product.saturating_mul(table.rows.len() as u64),
        Dimension::Sampler(_) => product,
    })
}

/// Reads a CSV file of parameters.
pub(crate) fn table(
    file: &Spanned<String>,
    resolution: &mut Resolution<'_>,
) -> Option<MatrixTable> {
    let found = read_table(resolution.dir, &file.value);
    for problem in found.problems {
        resolution.report(resolution.source.locate(problem, file.span));
    }
    found.source.into_iter().for_each(|source| resolution.sources.add(source));
    found.table
}

/// Reports parameters with the same environment variable.
fn check_names(names: &[(String, Span)], resolution: &mut Resolution<'_>) {
    for (index, (name, span)) in names.iter().enumerate() {
        let is_same = |(other, _): &&(String, Span)| variable(other) == variable(name);
        let Some((other, first)) = names[..index].iter().find(is_same) else { continue };
        let problem = resolution
            .source
            .error("duplicate-name", *span, describe_same_variable(other, name))
            .label(resolution.source.label(*first, "the first one"));
        resolution.report(problem);
    }
}

/// Reports parameters in constraints that do not exist or are not numbers.
fn check_constraints(
    campaign: &Campaign,
    names: &[(String, Span)],
    dimensions: &[Dimension<'_>],
    resolution: &mut Resolution<'_>,
) {
    let words = words(campaign, dimensions);
    for name in campaign.constraints.iter().flat_map(|constraint| constraint.parameters()) {
        let label = resolution.source.label(name.span, "");
        if !names.iter().any(|(known, _)| *known == name.value) {
            let message = format!("the campaign has no parameter `{}`", name.value);
            let known: Vec<_> = names.iter().map(|(known, _)| format!("`{known}`")).collect();
            let problem = Diagnostic::error("unknown-parameter", message).label(label);
            let hint = "a `-` after a letter belongs to the name: write `a - b` for a difference";
            let problem = if name.value.contains('-') { problem.hint(hint) } else { problem };
            resolution.report(problem.note(format!("its parameters are {}", known.join(", "))));
        } else if let Some((_, word)) =
            words.iter().find(|(known, word)| *known == name.value && number_of(word).is_none())
        {
            let message = format!("`{}` has the value `{word}`, which is not a number", name.value);
            resolution.report(Diagnostic::error("not-a-number", message).label(label));
        }
    }
}

/// All words that are values, each with the name of its parameter.
fn words<'a>(campaign: &'a Campaign, dimensions: &'a [Dimension<'_>]) -> Vec<(&'a str, &'a str)> {
    let mut found = Vec::new();
    for dimension in dimensions {
        if let Dimension::Table(table) = dimension {
            for row in &table.rows {
                let cells = table.names.iter().zip(row);
                found.extend(cells.map(|(name, word)| (name.as_str(), word.as_str())));
            }
        }
    }
    for parameter in &campaign.parameters {
        if let DeclaredParameter::Sampled {
            name,
            distribution: Distribution::Choice { values },
            ..
        } = parameter
        {
            found.extend(values.iter().map(|word| (name.value.as_str(), word.as_str())));
        }
    }
    found
}
