//! `requires`: what a suite needs for itself alone while it runs.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::value::Reader;
use super::{Resource, Spanned};

/// More of one kind is a mistake.
const MOST_SLOTS: u32 = 1000;

/// Reads the attribute of `<suite>`: `robot:icub arm:left/2`, in the order in
/// which locks are taken.
pub(super) fn read(reader: &mut Reader<'_>, root: Node<'_, '_>) -> Vec<Resource> {
    let mut resources: Vec<Resource> = Vec::new();
    for word in reader.words(root, "requires") {
        match resource(&word.value) {
            Ok(found) if resources.iter().any(|known| known.name == found.name) => {
                wrong(reader, &word, "is required twice", None);
            }
            Ok(found) => resources.push(found),
            Err((what, hint)) => wrong(reader, &word, &what, hint),
        }
    }
    resources.sort_by(|a, b| a.name.cmp(&b.name));
    resources
}

fn resource(word: &str) -> Result<Resource, (String, Option<&'static str>)> {
    let (name, slots) = match word.split_once('/') {
        None => (word, 1),
        Some((name, slots)) => {
            let number = slots.parse().ok().filter(|slots| (1..=MOST_SLOTS).contains(slots));
            let what = || format!("has `{slots}`, expected a number from 1 to {MOST_SLOTS}");
            let hint = "`gpu/2`: two suites at a time may have a `gpu`";
            (name, number.ok_or_else(|| (what(), Some(hint)))?)
        }
    };
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-.:".contains(c);
    if name.is_empty() || name.starts_with('.') || !name.chars().all(plain) {
        let hint = "letters, digits, `_`, `-`, `.` and `:`, for example `robot:icub`";
        return Err(("is not the name of a resource".to_owned(), Some(hint)));
    }
    Ok(Resource { name: name.to_owned(), slots })
}

fn wrong(reader: &mut Reader<'_>, word: &Spanned<String>, what: &str, hint: Option<&str>) {
    let message = format!("`{}` {what}", word.value);
    let label = reader.source.label(word.span, "");
    let problem = Diagnostic::error("invalid-value", message).label(label);
    reader.report(match hint {
        Some(hint) => problem.hint(hint),
        None => problem,
    });
}
