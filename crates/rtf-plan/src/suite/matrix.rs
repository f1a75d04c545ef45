//! `<matrix>` and `<matrix-exclude>`: the values with which a test runs.

use roxmltree::Node;
use rtf_model::{Diagnostic, Parameter};

use super::reader::ElementReader;
use super::schema::{self, check, check_content};
use super::{Span, Spanned};
use crate::config::is_name;

#[derive(Clone, Debug, Default)]
pub struct DeclaredMatrix {
    /// Its dimensions, in order.
    pub dimensions: Vec<MatrixDimension>,
    pub excludes: Vec<MatrixExclude>,
}

#[derive(Clone, Debug)]
pub enum MatrixDimension {
    /// One parameter and its values.
    Values(Spanned<String>, Vec<String>),
    /// A CSV file, whose header row names the parameters.
    File(Spanned<String>),
}

/// A `<matrix-exclude>`: excludes the combinations that have all of these values.
#[derive(Clone, Debug)]
pub struct MatrixExclude {
    /// The position of the tag.
    pub span: Span,
    /// The names and values of parameters.
    pub values: Vec<(Spanned<String>, String)>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Combination {
    /// Whether it is the first one of its test.
    pub is_first: bool,
    /// The values, in the order of the matrix.
    pub parameters: Vec<Parameter>,
}

/// Reads the matrix of a test; `None` if it has none, or if an element is invalid.
pub(super) fn read(reader: &mut ElementReader<'_>, test: Node<'_, '_>) -> Option<DeclaredMatrix> {
    test.first_element_child()?;
    let mut matrix = DeclaredMatrix::default();
    let mut is_valid = true;
    for node in test.children().filter(|node| node.has_tag_name("matrix")) {
        check(reader, node, &schema::MATRIX);
        match dimension(reader, node) {
            Some(dimension) => matrix.dimensions.push(dimension),
            None => is_valid = false,
        }
    }
    for node in test.children().filter(|node| node.has_tag_name("matrix-exclude")) {
        check_content(reader, node, &schema::MATRIX_EXCLUDE);
        match exclude(reader, node) {
            Some(exclude) => matrix.excludes.push(exclude),
            None => is_valid = false,
        }
    }
    if let (true, Some(first)) = (matrix.dimensions.is_empty(), matrix.excludes.first())
        && is_valid
    {
        let message = "`<matrix-exclude>` has no effect without `<matrix>`";
        reader.report(reader.error("without-effect", first.span, message));
    }
    (is_valid && !matrix.dimensions.is_empty()).then_some(matrix)
}

fn dimension(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<MatrixDimension> {
    if node.has_attribute("values-from") {
        let given = ["name", "values"].into_iter().find(|name| node.has_attribute(*name));
        if let Some(attribute) = given.and_then(|name| reader.attribute(node, name)) {
            let message = "a `<matrix>` has either `values-from`, or `name` and `values`";
            let problem = reader
                .error("conflicting-attributes", attribute.span, message)
                .hint("the header row of the file names the parameters");
            reader.report(problem);
            return None;
        }
        return reader.word(node, "values-from").map(MatrixDimension::File);
    }
    for name in ["name", "values"] {
        if !node.has_attribute(name) {
            let other = if name == "values" { ", or `values-from`" } else { "" };
            reader.missing(node, &format!("the attribute `{name}`{other}"));
            return None;
        }
    }
    let name = reader.word(node, "name");
    let name = name.filter(|name| check_name(reader, name));
    let values = values(reader, node);
    Some(MatrixDimension::Values(name?, values?))
}

/// Checks the name of a parameter and reports an invalid one.
pub fn check_name(reader: &mut ElementReader<'_>, name: &Spanned<String>) -> bool {
    check_parameter(reader, "name", name)
}

/// Reports an attribute that is not the name of a parameter. Returns whether it is one.
pub fn check_parameter(
    reader: &mut ElementReader<'_>,
    attribute: &str,
    name: &Spanned<String>,
) -> bool {
    let is_valid = is_name(&name.value);
    if !is_valid {
        let hint = "letters, digits, `-` and `_`, a letter first";
        reader.wrong(attribute, name, "is not the name of a parameter", Some(hint));
    }
    is_valid
}

/// Reads the values of a parameter, and reports invalid ones.
pub fn values(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<Vec<String>> {
    let words = reader.words(node, "values");
    if words.is_empty() {
        let problem = Diagnostic::error(
            "empty-matrix",
            format!("a `<{}>` without values", node.tag_name().name()),
        );
        let span = reader.attribute(node, "values")?.span;
        reader.report(problem.label(reader.source.label(span, "")));
        return None;
    }
    let mut values: Vec<String> = Vec::with_capacity(words.len());
    let mut is_valid = true;
    for word in words {
        let problem = if values.contains(&word.value) {
            Some(format!("the value `{}` occurs twice", word.value))
        } else {
            invalid_value(&word.value)
        };
        if let Some(message) = problem {
            reader.report(reader.error("invalid-value", word.span, message));
            is_valid = false;
        }
        values.push(word.value);
    }
    is_valid.then_some(values)
}

/// Returns why a text cannot be a value of a matrix.
pub(crate) fn invalid_value(value: &str) -> Option<String> {
    if value.contains("${param:") || value.contains("${port:") {
        return Some(format!("a value of a matrix cannot contain a placeholder: `{value}`"));
    }
    value
        .contains(char::is_control)
        .then(|| format!("a value of a matrix contains a control character: {value:?}"))
}

fn exclude(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<MatrixExclude> {
    let span = ElementReader::tag(node);
    let attributes = node.attributes().filter(|attribute| attribute.namespace().is_none());
    let values: Vec<_> = attributes
        .map(|attribute| {
            let name = attribute.name().to_owned();
            let name = Spanned::new(name, Span::new(attribute.range_qname()));
            (name, attribute.value().to_owned())
        })
        .collect();
    if values.is_empty() {
        reader.missing(node, "at least one parameter: `<matrix-exclude joint=\"0\"/>`");
        return None;
    }
    Some(MatrixExclude { span, values })
}
