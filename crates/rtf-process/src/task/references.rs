//! Stored files that tests compare with: below the directory of the suite.

use std::fs::File;
use std::io::ErrorKind;
use std::path::{Component, Path};

/// Why a reference is refused; `None` if it is a path below the directory of the suite.
pub(super) fn outside_of_suite(reference: &str) -> Option<String> {
    let mut parts = Path::new(reference).components();
    let is_below = parts.all(|part| matches!(part, Component::Normal(_)));
    (!is_below || reference.is_empty()).then(|| {
        format!("the reference `{reference}` is not a path below the directory of the suite")
    })
}

/// Opens a reference. `what` is compared in this run.
///
/// # Errors
/// It cannot be read; the text has a hint if there is none.
pub(super) fn open_reference(
    working_dir: &Path,
    name: &str,
    (what, run): (&str, &str),
) -> Result<File, String> {
    super::file_copy::open(&working_dir.join(name)).map_err(|error| match error.kind() {
        ErrorKind::NotFound => format!(
            "there is no reference `{name}`; hint: if the {what} is right, store it with \
             `rtf golden accept {run}`"
        ),
        _ => format!("cannot read `{name}`: {error}"),
    })
}
