//! The JSON Schemas of the event stream, the host protocol and the web API, for programs
//! that are not written in Rust, and that of `rtf.toml`, for editors.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use rtf_model::protocol::{Answer, Initialized, Notification, Request};
use rtf_model::{Diagnostic, Event};
use schemars::{JsonSchema, SchemaGenerator};
use serde::Serialize;

use crate::openapi;

/// Where they are kept, relative to the workspace.
const FOLDER: &str = "schemas";

/// How many lines are shown from the first one that differs.
const SHOWN: usize = 5;

/// Why the schemas could not be written, or are not those of the code.
#[derive(Debug, thiserror::Error)]
pub enum SchemaError {
    #[error("cannot read or write `{}`", path.display())]
    File { path: PathBuf, source: io::Error },
    #[error("cannot write a schema as text")]
    Text(#[source] serde_json::Error),
    /// Each with what differs.
    #[error(
        "the schemas are not those of the code: \
         run `cargo run -p xtask -- schemas` and commit what it changes{}",
        listed(.0)
    )]
    Differ(Vec<(PathBuf, String)>),
}

fn listed(files: &[(PathBuf, String)]) -> String {
    files.iter().map(|(path, what)| format!("\n{}: {what}", path.display())).collect()
}

/// Writes the schemas, or with `check` compares those that are there.
///
/// # Errors
/// They cannot be read or written, or differ.
pub fn run(check: bool) -> Result<(), SchemaError> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(FOLDER);
    let schemas = all()?;
    if check { compare(&folder, &schemas) } else { write(&folder, &schemas) }
}

type Named = (&'static str, String);

fn all() -> Result<Vec<Named>, SchemaError> {
    Ok(vec![
        ("event.json", schema::<Event>()?),
        ("diagnostic.json", schema::<Diagnostic>()?),
        ("request.json", schema::<Request>()?),
        ("notification.json", schema::<Notification>()?),
        ("initialized.json", schema::<Initialized>()?),
        ("answer.json", schema::<Answer>()?),
        ("config.json", text(&rtf_plan::config::json_schema())?),
        ("limits.json", text(&rtf_plan::envelope::json_schema())?),
        ("openapi.json", openapi::description().map_err(SchemaError::Text)? + "\n"),
    ])
}

fn schema<T: JsonSchema>() -> Result<String, SchemaError> {
    text(&SchemaGenerator::default().into_root_schema_for::<T>())
}

fn text(schema: &impl Serialize) -> Result<String, SchemaError> {
    Ok(serde_json::to_string_pretty(schema).map_err(SchemaError::Text)? + "\n")
}

fn write(folder: &Path, schemas: &[Named]) -> Result<(), SchemaError> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        |source| SchemaError::File { path, source }
    };
    fs::create_dir_all(folder).map_err(failed(folder))?;
    for (name, text) in schemas {
        let path = folder.join(name);
        fs::write(&path, text).map_err(failed(&path))?;
    }
    strays(folder, schemas)?
        .into_iter()
        .try_for_each(|path| fs::remove_file(&path).map_err(failed(&path)))
}

fn compare(folder: &Path, schemas: &[Named]) -> Result<(), SchemaError> {
    let mut differ = Vec::new();
    for (name, wanted) in schemas {
        let shown = Path::new(FOLDER).join(name);
        match fs::read_to_string(folder.join(name)) {
            Ok(found) if found == *wanted => {}
            Ok(found) => differ.push((shown, difference(&found, wanted))),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                differ.push((shown, "is missing".to_owned()));
            }
            Err(source) => return Err(SchemaError::File { path: shown, source }),
        }
    }
    for path in strays(folder, schemas)? {
        let name = path.file_name().unwrap_or_default();
        differ.push((Path::new(FOLDER).join(name), "is made from no type".to_owned()));
    }
    if differ.is_empty() { Ok(()) } else { Err(SchemaError::Differ(differ)) }
}

/// Schemas that are kept and that the code does not make.
fn strays(folder: &Path, schemas: &[Named]) -> Result<Vec<PathBuf>, SchemaError> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(source) => return Err(SchemaError::File { path: folder.to_owned(), source }),
    };
    let paths = entries.filter_map(Result::ok).map(|entry| entry.path());
    let is_made = |path: &PathBuf| schemas.iter().any(|(name, _)| path.ends_with(name));
    let is_schema = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "json");
    let mut strays: Vec<_> = paths.filter(|path| is_schema(path) && !is_made(path)).collect();
    strays.sort();
    Ok(strays)
}

/// The first lines that differ, with `-` those that are kept, with `+` those
/// that the code makes.
fn difference(found: &str, wanted: &str) -> String {
    let same = found.lines().zip(wanted.lines()).take_while(|(a, b)| a == b).count();
    let mut text = format!("differs from line {} on", same + 1);
    for (sign, side) in [('-', found), ('+', wanted)] {
        for line in side.lines().skip(same).take(SHOWN) {
            text += &format!("\n  {sign} {line}");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_shows_both_sides_from_the_first_line_that_differs() {
        let text = difference("{\n  \"a\": 1\n}\n", "{\n  \"b\": 1\n}\n");
        assert_eq!(text, "differs from line 2 on\n  -   \"a\": 1\n  - }\n  +   \"b\": 1\n  + }");
    }

    #[test]
    fn missing_and_stray_schemas_are_found() {
        let folder = std::env::temp_dir().join(format!("rtf-schemas-{}", std::process::id()));
        let schemas = all().unwrap();
        write(&folder, &schemas).unwrap();
        compare(&folder, &schemas).unwrap();
        fs::rename(folder.join("event.json"), folder.join("evnt.json")).unwrap();
        let Err(SchemaError::Differ(files)) = compare(&folder, &schemas) else {
            panic!("a schema is missing")
        };
        let told: Vec<_> = files.iter().map(|(_, what)| what.as_str()).collect();
        assert_eq!(told, ["is missing", "is made from no type"]);
        fs::remove_dir_all(folder).unwrap();
    }
}
