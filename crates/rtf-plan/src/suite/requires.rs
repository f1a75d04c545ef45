//! `requires`: the exclusive resources of a suite.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::reader::ElementReader;
use super::{RequiredResource, Spanned};

/// The maximum number of slots; a larger number is a mistake.
const MAX_SLOTS: u32 = 1000;

/// Reads the attribute `robot:icub arm:left/2`. The result is in lock order.
pub(super) fn read(reader: &mut ElementReader<'_>, root: Node<'_, '_>) -> Vec<RequiredResource> {
    let mut resources: Vec<RequiredResource> = Vec::new();
    for word in reader.words(root, "requires") {
        match parse_resource(&word.value) {
            Ok(found) if resources.iter().any(|known| known.name == found.name) => {
                report_invalid(reader, &word, "is required twice", None);
            }
            Ok(found) => resources.push(found),
            Err((what, hint)) => report_invalid(reader, &word, &what, hint),
        }
    }
    resources.sort_by(|a, b| a.name.cmp(&b.name));
    resources
}

fn parse_resource(word: &str) -> Result<RequiredResource, (String, Option<&'static str>)> {
    let (name, slots) = match word.split_once('/') {
        None => (word, 1),
        Some((name, slots)) => {
            let number = slots.parse().ok().filter(|slots| (1..=MAX_SLOTS).contains(slots));
            let what = || format!("has `{slots}`, expected a number from 1 to {MAX_SLOTS}");
            let hint = "with `gpu/2`, two suites at a time can use a `gpu`";
            (name, number.ok_or_else(|| (what(), Some(hint)))?)
        }
    };
    let is_allowed = |c: char| c.is_ascii_alphanumeric() || "_-.:".contains(c);
    if name.is_empty() || name.starts_with('.') || !name.chars().all(is_allowed) {
        let hint = "letters, digits, `_`, `-`, `.` and `:`, for example `robot:icub`";
        return Err(("is not the name of a resource".to_owned(), Some(hint)));
    }
    Ok(RequiredResource { name: name.to_owned(), slots })
}

fn report_invalid(
    reader: &mut ElementReader<'_>,
    word: &Spanned<String>,
    what: &str,
    hint: Option<&str>,
) {
    let message = format!("`{}` {what}", word.value);
    let problem = reader.error("invalid-value", word.span, message);
    reader.report(Diagnostic { hint: hint.map(str::to_owned), ..problem });
}
