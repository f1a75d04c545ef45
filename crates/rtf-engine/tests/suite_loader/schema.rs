//! The schema and the loader agree.

use std::path::Path;
use std::process::Command;

use rtf_engine::suite;
use rtf_model::Severity;

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
    // 3 and 4: the file does not fit; anything else: the schema or the call is wrong.
    assert!(matches!(output.status.code(), Some(0 | 3 | 4)), "{text}");
    (output.status.success(), text)
}

#[test]
fn the_schema_and_the_loader_accept_the_same_files() {
    let legacy = data("legacy").into_iter().filter(|path| {
        // Not well-formed: no other program reads these.
        !path.file_name().unwrap().to_str().unwrap().starts_with("dashes")
    });
    for path in data("valid").into_iter().chain(legacy) {
        let (valid, said) = xmllint(&path);
        assert!(valid, "{said}");
    }
    for path in data("invalid") {
        let (valid, _) = xmllint(&path);
        assert!(!valid, "the schema accepts {}", path.display());
        let source = suite::open(&path, "a.xml").unwrap();
        let mut found = Vec::new();
        let loaded = suite::load(&source, &mut found);
        // Whether a type is known is for the planner to say.
        let left_to_plan = path.file_stem().unwrap() == "type";
        let refused = loaded.is_none() || found.iter().any(|p| p.severity == Severity::Error);
        assert!(refused != left_to_plan, "{}: {found:?}", path.display());
    }
}
