//! The predecessor's files load unchanged.

use rtf_model::Severity;
use rtf_plan::suite::FixtureKind;

use crate::{at, data, file, positions};

#[test]
fn the_predecessors_files_load_unchanged() {
    for path in data("legacy") {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let (suite, problems) = file(&format!("legacy/{name}"));
        assert!(!suite.tests.is_empty(), "{name}");
        let codes: Vec<_> = problems.iter().map(|problem| problem.code.as_str()).collect();
        let expected: &[&str] = if name.starts_with("dashes") { &["comment-dashes"] } else { &[] };
        assert_eq!(codes, expected, "{name}");
        assert!(problems.iter().all(|problem| problem.severity == Severity::Warning));
    }
}

#[test]
fn a_predecessors_file_in_full() {
    let (suite, _) = file("legacy/basics.xml");
    assert_eq!(suite.name.unwrap().value, "Basic checks");
    assert_eq!(suite.settings.description, "Checking the basic features of the robot");
    assert_eq!(suite.settings.environment, "--robot simulator");
    let FixtureKind::Plugin(fixture) = &suite.fixtures[0].body else { panic!("a plug-in") };
    assert_eq!(fixture.name.value, "AppLauncher");
    assert_eq!(fixture.param, "--fixture launch-simulator.xml");
    let tests: Vec<_> = suite
        .tests
        .iter()
        .map(|test| (test.plugin.name.value.as_str(), test.plugin.param.as_str()))
        .collect();
    assert_eq!(
        tests,
        [
            ("SensorRate", "--from sensors_left.ini"),
            ("SensorRate", "--from sensors_right.ini"),
            ("BoardVersions", ""),
        ]
    );
}

#[test]
fn comments_with_dashes_are_ignored() {
    let (suite, problems) = file("legacy/dashes-options.xml");
    let params: Vec<_> = suite.tests.iter().map(|test| test.plugin.param.as_str()).collect();
    assert_eq!(params, ["--from arms.ini", "--from torso.ini"]);
    let label = &problems[0].labels[0];
    assert_eq!((label.line, label.column), (6, 34));
    assert_eq!(problems[0].notes, ["one more comment of this file contains it"]);
    let (suite, problems) = file("legacy/dashes-ruler.xml");
    assert_eq!(suite.tests[1].plugin.param, "--port /right --name \"right camera\"");
    assert_eq!(problems[0].notes, ["2 more comments of this file contain it"]);
}

#[test]
fn positions_after_a_blanked_comment_are_right() {
    let text = "<suite><!-- ü -- ü --><test timeout='x'>A</test></suite>";
    assert_eq!(positions(text), [at("comment-dashes", 1, 15), at("invalid-value", 1, 38)]);
    // Also for errors of the XML parser.
    let text = "<suite><!-- ü -- ü --><test>A</tset></suite>";
    assert_eq!(positions(text), [at("comment-dashes", 1, 15), at("malformed-xml", 1, 30)]);
}
