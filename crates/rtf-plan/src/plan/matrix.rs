//! Expands a test with a matrix into one test for each combination of values.

use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

use rtf_model::{Diagnostic, Parameter};

use super::matrix_file::{MatrixTable, read_table};
use crate::config::{describe_same_variable, variable};
use crate::suite::{
    Combination, DeclaredMatrix, DeclaredTest, MatrixDimension, MatrixExclude, SourceMap,
    SourceText, Span,
};
use crate::wording::{quoted, suggest};

/// The maximum number of combinations of one test.
const MAX_COMBINATIONS: usize = 10_000;
/// The maximum number of combinations before `<matrix-exclude>`.
const MAX_PRODUCT: usize = 1_000_000;

/// Expands the matrices of one suite, and reports their problems.
pub(super) struct MatrixExpander<'a> {
    /// The directory to which `values-from` is relative.
    pub dir: &'a Path,
    pub source: &'a SourceText,
    pub problems: &'a mut Vec<Diagnostic>,
    pub sources: &'a mut SourceMap,
    /// The CSV files read so far; `None` for an invalid one, which was reported.
    tables: HashMap<String, Option<Rc<MatrixTable>>>,
}

impl<'a> MatrixExpander<'a> {
    pub fn new(
        dir: &'a Path,
        source: &'a SourceText,
        problems: &'a mut Vec<Diagnostic>,
        sources: &'a mut SourceMap,
    ) -> Self {
        Self { dir, source, problems, sources, tables: HashMap::new() }
    }

    /// Replaces each test with a matrix by its combinations; omits it if the matrix is
    /// invalid.
    pub fn expand(&mut self, tests: Vec<DeclaredTest>) -> Vec<DeclaredTest> {
        if tests.iter().all(|test| test.matrix.is_none()) {
            return tests;
        }
        let mut expanded = Vec::with_capacity(tests.len());
        for mut test in tests {
            let Some(matrix) = test.matrix.take() else {
                expanded.push(test);
                continue;
            };
            let combinations = self.combinations(&matrix, test.span).unwrap_or_default();
            expanded.extend(combinations.into_iter().enumerate().map(|(index, parameters)| {
                let mut test = test.clone();
                let variables = parameters.iter().map(|it| (variable(&it.name), it.value.clone()));
                test.env.splice(0..0, variables);
                test.combination = Some(Combination { is_first: index == 0, parameters });
                test
            }));
        }
        expanded
    }

    fn combinations(&mut self, matrix: &DeclaredMatrix, span: Span) -> Option<Vec<Vec<Parameter>>> {
        let dimensions: Vec<_> =
            matrix.dimensions.iter().map(|dimension| self.table(dimension)).collect();
        let dimensions = dimensions.into_iter().collect::<Option<Vec<_>>>()?;
        self.check_names(&dimensions)?;
        let mut is_valid = true;
        for exclude in &matrix.excludes {
            is_valid &= self.check_exclude(exclude, &dimensions);
        }
        if !is_valid {
            return None;
        }
        let product = dimensions
            .iter()
            .fold(1_usize, |product, (table, _)| product.saturating_mul(table.rows.len()));
        if product > MAX_PRODUCT {
            let size = format!(
                "{product} combinations before `<matrix-exclude>`, more than {MAX_PRODUCT}"
            );
            let hint = "a campaign samples a large space of parameters";
            self.report_size(&size, hint, span);
            return None;
        }
        let is_excluded = |combination: &Vec<Parameter>| {
            matrix.excludes.iter().any(|exclude| excludes(exclude, combination))
        };
        let mut combinations = product_of(&dimensions);
        combinations.retain(|combination| !is_excluded(combination));
        if combinations.len() > MAX_COMBINATIONS {
            let hint = "a campaign samples a large space of parameters; in a suite, exclude \
                        combinations with `<matrix-exclude>`";
            let size = format!("{} combinations, more than {MAX_COMBINATIONS}", combinations.len());
            self.report_size(&size, hint, span);
            return None;
        }
        if combinations.is_empty() {
            let message = "`<matrix-exclude>` excludes every combination of the matrix";
            self.report("empty-matrix", message, span);
            return None;
        }
        Some(combinations)
    }

    /// Returns the values of a dimension, and its position in the suite.
    fn table(&mut self, dimension: &MatrixDimension) -> Option<(Rc<MatrixTable>, Span)> {
        match dimension {
            MatrixDimension::Values(name, values) => {
                let rows = values.iter().map(|value| vec![value.clone()]).collect();
                let table = MatrixTable { names: vec![name.value.clone()], rows };
                Some((Rc::new(table), name.span))
            }
            MatrixDimension::File(file) => {
                if let Some(known) = self.tables.get(&file.value) {
                    return known.clone().map(|table| (table, file.span));
                }
                let found = read_table(self.dir, &file.value);
                let problems = found.problems.into_iter();
                self.problems.extend(problems.map(|it| self.source.locate(it, file.span)));
                found.source.into_iter().for_each(|source| self.sources.add(source));
                let table = found.table.map(Rc::new);
                self.tables.insert(file.value.clone(), table.clone());
                table.map(|table| (table, file.span))
            }
        }
    }

    /// Reports parameters with the same environment variable.
    fn check_names(&mut self, dimensions: &[(Rc<MatrixTable>, Span)]) -> Option<()> {
        let mut known: HashMap<String, (&str, Span)> = HashMap::new();
        for (table, span) in dimensions {
            for name in &table.names {
                let Some((other, first)) = known.insert(variable(name), (name, *span)) else {
                    continue;
                };
                let message = describe_same_variable(other, name);
                let problem = self
                    .source
                    .error("duplicate-name", *span, message)
                    .label(self.source.label(first, "the first one"));
                self.problems.push(problem);
                return None;
            }
        }
        Some(())
    }

    /// Reports unknown names, and warns about values that do not occur.
    fn check_exclude(
        &mut self,
        exclude: &MatrixExclude,
        dimensions: &[(Rc<MatrixTable>, Span)],
    ) -> bool {
        let mut is_valid = true;
        for (name, value) in &exclude.values {
            let column = dimensions.iter().find_map(|(table, _)| {
                let index = table.names.iter().position(|known| *known == name.value)?;
                Some((table, index))
            });
            let label = self.source.label(name.span, "");
            let Some((table, index)) = column else {
                let known = || {
                    let names = dimensions.iter().flat_map(|(table, _)| &table.names);
                    names.map(String::as_str)
                };
                let message = format!("the matrix has no parameter `{}`", name.value);
                let problem = Diagnostic::error("unknown-param", message)
                    .label(label)
                    .note(format!("its parameters are {}", quoted(known(), ", ")));
                self.problems.push(suggest(problem, &name.value, known()));
                is_valid = false;
                continue;
            };
            if !table.rows.iter().any(|row| row[index] == *value) {
                let name = &name.value;
                let message = format!("no combination has `{name}={value}`: it excludes nothing");
                self.problems.push(Diagnostic::warning("without-effect", message).label(label));
            }
        }
        is_valid
    }

    fn report_size(&mut self, size: &str, hint: &str, span: Span) {
        let message = format!("the matrix has {size}");
        let problem = Diagnostic::error("matrix-too-large", message).hint(hint);
        self.problems.push(problem.label(self.source.label(span, "")));
    }

    fn report(&mut self, code: &str, message: &str, span: Span) {
        self.problems.push(self.source.error(code, span, message));
    }
}

/// Returns all combinations; the last dimension varies fastest.
fn product_of(dimensions: &[(Rc<MatrixTable>, Span)]) -> Vec<Vec<Parameter>> {
    let mut combinations = vec![Vec::new()];
    for (table, _) in dimensions {
        combinations = combinations
            .iter()
            .flat_map(|start: &Vec<Parameter>| {
                table.rows.iter().map(move |row| {
                    let values = table.names.iter().zip(row);
                    let parameters = values.map(|(name, value)| Parameter {
                        name: name.clone(),
                        value: value.clone(),
                    });
                    start.iter().cloned().chain(parameters).collect()
                })
            })
            .collect();
    }
    combinations
}

fn excludes(exclude: &MatrixExclude, combination: &[Parameter]) -> bool {
    exclude.values.iter().all(|(name, value)| {
        combination.iter().any(|known| known.name == name.value && known.value == *value)
    })
}

/// Returns the name of one combination: `Move[joint=0,speed=slow]`.
pub(super) fn combination_name(base: &str, parameters: &[Parameter]) -> String {
    let values: Vec<_> = parameters.iter().map(|it| format!("{}={}", it.name, it.value)).collect();
    format!("{base}[{}]", values.join(","))
}
