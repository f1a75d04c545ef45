//! `<parameter>`.

use roxmltree::Node;
use rtf_model::Diagnostic;
use rtf_plan::suite::schema::check;
use rtf_plan::suite::{ElementReader, Span, Spanned, matrix};
use serde::Serialize;

use super::{real, schema};

#[derive(Clone, Debug, PartialEq)]
pub enum DeclaredParameter {
    /// All combinations with the other grids and files.
    Grid {
        name: Spanned<String>,
        values: Vec<String>,
        /// The nominal value; `None` for the first one.
        nominal: Option<String>,
    },
    /// The rows of a CSV file, whose header names the parameters.
    File(Spanned<String>),
    /// A value for each episode.
    Sampled {
        name: Spanned<String>,
        design: Design,
        distribution: Distribution,
        /// The nominal value; `None` for the middle of the distribution, or its first word.
        nominal: Option<String>,
    },
}

/// How the values of the episodes depend on each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Design {
    Independent,
    /// One in each of as many equal parts as there are episodes.
    LatinHypercube,
    Sobol,
}

/// The values of a parameter, and how probable they are.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Distribution {
    /// One of these words, each with the same probability.
    Choice {
        /// The words.
        values: Vec<String>,
    },
    /// A number between these.
    Uniform {
        /// The lowest value.
        low: f64,
        /// The highest value.
        high: f64,
    },
    Normal {
        mean: f64,
        /// The standard deviation.
        deviation: f64,
    },
}

impl DeclaredParameter {
    /// Returns the position of the name or of the file.
    #[must_use]
    pub fn span(&self) -> Span {
        match self {
            Self::Grid { name, .. } | Self::File(name) | Self::Sampled { name, .. } => name.span,
        }
    }

    /// Whether the values of an episode do not depend on those of others.
    #[must_use]
    pub fn is_independent(&self) -> bool {
        matches!(self, Self::Sampled { design: Design::Independent, .. })
    }
}

/// The value of `distribution`.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Grid,
    File,
    Choice,
    Uniform,
    Normal,
    Design(Design),
}

const KINDS: [(&str, Kind); 7] = [
    ("grid", Kind::Grid),
    ("file", Kind::File),
    ("choice", Kind::Choice),
    ("uniform", Kind::Uniform),
    ("normal", Kind::Normal),
    ("latin-hypercube", Kind::Design(Design::LatinHypercube)),
    ("sobol", Kind::Design(Design::Sobol)),
];

/// Reads a `<parameter>`; `None` if it is invalid, which is reported.
pub(super) fn read(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
) -> Option<DeclaredParameter> {
    let Some(kind) = reader.choice(node, "distribution", &KINDS) else {
        check(reader, node, &schema::PARAMETER);
        if !node.has_attribute("distribution") {
            reader.missing(node, "the attribute `distribution`");
        }
        return None;
    };
    check(reader, node, known(kind));
    if kind == Kind::File {
        return reader.required(node, "file", "").map(DeclaredParameter::File);
    }
    let name = name(reader, node);
    if kind == Kind::Grid {
        let (values, nominal) = (words(reader, node), nominal(reader, node, true));
        return Some(DeclaredParameter::Grid { name: name?, values: values?, nominal: nominal? });
    }
    let distribution = distribution(reader, node, kind);
    let design = if let Kind::Design(design) = kind { design } else { Design::Independent };
    let is_word = matches!(distribution, Some(Distribution::Choice { .. }));
    let nominal = nominal(reader, node, is_word);
    let (name, distribution, nominal) = (name?, distribution?, nominal?);
    Some(DeclaredParameter::Sampled { name, design, distribution, nominal })
}

/// The attribute `nominal`; `None` if it is invalid, which is reported.
#[expect(clippy::option_option, reason = "the attribute is optional")]
fn nominal(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    is_word: bool,
) -> Option<Option<String>> {
    if !node.has_attribute("nominal") {
        return Some(None);
    }
    if !is_word {
        real::required(reader, node, "nominal")?;
    }
    reader.word(node, "nominal").map(|word| Some(word.value))
}

fn known(kind: Kind) -> &'static rtf_plan::suite::schema::ElementSchema {
    match kind {
        Kind::Grid | Kind::Choice => &schema::WORDS,
        Kind::File => &schema::FILE,
        Kind::Uniform => &schema::UNIFORM,
        Kind::Normal => &schema::NORMAL,
        Kind::Design(_) => &schema::DESIGN,
    }
}

fn name(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<Spanned<String>> {
    reader.required(node, "name", "").filter(|name| matrix::check_name(reader, name))
}

fn words(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<Vec<String>> {
    if !node.has_attribute("values") {
        reader.missing(node, "the attribute `values`");
        return None;
    }
    matrix::values(reader, node)
}

fn distribution(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    kind: Kind,
) -> Option<Distribution> {
    let kind =
        if let Kind::Design(_) = kind { distribution_of_design(reader, node)? } else { kind };
    match kind {
        Kind::Choice => words(reader, node).map(|values| Distribution::Choice { values }),
        Kind::Normal => {
            let mean = real::required(reader, node, "mean");
            let deviation = real::between_zero_and(reader, node, "deviation", f64::INFINITY);
            Some(Distribution::Normal { mean: mean?.value, deviation: deviation?.value })
        }
        _ => {
            let [low, high] = real::ascending(reader, node, ["low", "high"])?;
            Some(Distribution::Uniform { low, high })
        }
    }
}

/// A design has the attributes of one distribution.
fn distribution_of_design(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<Kind> {
    let groups: [(Kind, &[&str]); 3] = [
        (Kind::Choice, &["values"]),
        (Kind::Uniform, &["low", "high"]),
        (Kind::Normal, &["mean", "deviation"]),
    ];
    let used = |names: &[&str]| names.iter().any(|name| node.has_attribute(*name));
    let mut found = groups.iter().filter(|(_, names)| used(names));
    let Some((kind, first)) = found.next() else {
        let groups = "`low` and `high`, `mean` and `deviation`, or `values`";
        reader.missing(node, &format!("the attributes {groups}"));
        return None;
    };
    if let Some((_, other)) = found.next() {
        let label = |name: &str| {
            let attribute = reader.attribute(node, name)?;
            Some(reader.source.label(attribute.span, ""))
        };
        let labels: Vec<_> = [other, first].into_iter().flat_map(|names| names.iter()).collect();
        let labels = labels.into_iter().filter_map(|name| label(name));
        let message = "a `<parameter>` has one distribution";
        let problem = Diagnostic::error("conflicting-attributes", message);
        let problem = labels.fold(problem, Diagnostic::label);
        let hint = "`low` and `high`, `mean` and `deviation`, or `values`";
        reader.report(problem.hint(hint));
        return None;
    }
    Some(*kind)
}
