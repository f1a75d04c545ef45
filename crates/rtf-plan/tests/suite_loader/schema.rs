//! The schema and the loader agree.

use std::path::Path;
use std::process::Command;

use rtf_model::Severity;
use rtf_plan::suite;

use crate::data;

fn xmllint(path: &Path) -> (bool, String) {
    let schema = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec/suite.xsd");
    let output = Command::new("xmllint")
        .args(["--noout", "--nonet", "--schema"])
        .arg(schema)
        .arg(path)
        .output()
        .expect("xmllint, of the package libxml2-utils");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    // 3 and 4: the file is invalid; anything else: the schema or the call is wrong.
    assert!(matches!(output.status.code(), Some(0 | 3 | 4)), "{text}");
    (output.status.success(), text)
}

#[test]
fn the_schema_and_the_loader_accept_the_same_files() {
    let legacy = data("legacy").into_iter().filter(|path| {
        // Not well-formed XML.
        !path.file_name().unwrap().to_str().unwrap().starts_with("dashes")
    });
    for path in data("valid").into_iter().chain(legacy) {
        let (valid, output) = xmllint(&path);
        assert!(valid, "{output}");
    }
    for path in data("invalid") {
        let (valid, _) = xmllint(&path);
        assert!(!valid, "the schema accepts {}", path.display());
        let source = suite::read_source(&path, "a.xml").unwrap();
        let mut found = Vec::new();
        let loaded = suite::parse(&source, &mut found);
        // The planner checks whether a type is known.
        let is_for_planner = path.file_stem().unwrap() == "type";
        let is_refused = loaded.is_none() || found.iter().any(|p| p.severity == Severity::Error);
        assert!(is_refused != is_for_planner, "{}: {found:?}", path.display());
    }
}
