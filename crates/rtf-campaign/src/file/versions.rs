//! `<versions>`: the versions that are tried in each condition.

use roxmltree::Node;
use rtf_plan::suite::schema::check;
use rtf_plan::suite::{ElementReader, Span, Spanned, matrix};

use super::schema;

/// A shorter text occurs in other words, and cannot be masked.
const MIN_BLINDED_CHARS: usize = 3;

/// Versions that are tried and compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Versions {
    /// The position of the tag.
    pub span: Span,
    /// The parameter of the suite whose value is the version.
    pub parameter: Spanned<String>,
    /// At least two different ones. The first one is the baseline.
    pub values: Vec<String>,
    /// Whether they are hidden until all trials have results.
    pub blinded: bool,
}

impl Versions {
    /// The block of a trial; both are numbered from 1.
    #[must_use]
    pub fn block(&self, trial: u64) -> u64 {
        trial.saturating_sub(1) / (self.values.len() as u64).max(1) + 1
    }

    /// The texts that are not shown, the longest first: one may be a part of another.
    #[must_use]
    pub fn masked(&self) -> Vec<String> {
        let mut masked = if self.blinded { self.values.clone() } else { Vec::new() };
        masked.sort_by_key(|value| std::cmp::Reverse(value.len()));
        masked
    }
}

/// Reads the `<versions>`; `None` if they are invalid, which is reported.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<Versions> {
    check(reader, node, &schema::VERSIONS);
    let parameter = reader.required(node, "parameter", "");
    let parameter = parameter.filter(|name| matrix::check_parameter(reader, "parameter", name));
    let before = reader.problems.len();
    let blinded = reader.boolean(node, "blinded").unwrap_or_default();
    if !node.has_attribute("values") {
        reader.missing(node, "the attribute `values`");
        return None;
    }
    let values = matrix::values(reader, node);
    if let ([only], Some(_)) = (reader.words(node, "values").as_slice(), &values) {
        let hint = "the first version is compared with the others: `values=\"old new\"`";
        reader.wrong("values", only, "has only one version", Some(hint));
    }
    if blinded {
        check_blinded(reader, node);
    }
    let is_valid = reader.problems.len() == before;
    let span = ElementReader::tag(node);
    Some(Versions { span, parameter: parameter?, values: values?, blinded }).filter(|_| is_valid)
}

fn check_blinded(reader: &mut ElementReader<'_>, node: Node<'_, '_>) {
    for word in reader.words(node, "values") {
        if word.value.chars().count() < MIN_BLINDED_CHARS {
            let what = format!("has a version with fewer than {MIN_BLINDED_CHARS} characters");
            let hint = "it is replaced in everything that is shown, also in other words: choose a \
                        longer one, or leave `blinded` out";
            reader.wrong("values", &word, &what, Some(hint));
        }
    }
}
