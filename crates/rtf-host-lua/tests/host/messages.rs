//! What the messages say.

use serde_json::{Value, json};

use crate::driver::run_body;

#[test]
fn what_is_not_near_is_told_with_its_numbers() {
    let cases = [
        ("check_near(1.25, 1, 0.1, 'gain')", "gain: got 1.25, expected 1 ± 0.1 (off by 0.25)"),
        (
            "check_near({1, 2, 3.5}, {1, 2, 3}, 0.1, 'pose')",
            "pose: got 3.5, expected 3 ± 0.1 (off by 0.5) at index 2",
        ),
        (
            "check_near({{1, 2}, {3, 9}}, {{1, 2}, {3, 4}}, 0.1, 'pose')",
            "pose: got 9, expected 4 ± 0.1 (off by 5) at index 3",
        ),
        ("check_near({1, 2}, {1, 2, 3}, 0.1, 'pose')", "pose: got 2 values, expected 3"),
        ("check_near(0/0, 1, 0.1, 'gain')", "gain: got nan, expected 1 ± 0.1"),
        ("check_near({0, 1/0}, {5, 1/0}, 9, 'gain')", "gain: got inf, expected inf ± 9 at index 1"),
        ("check_angle_near(0, 1, 0.1, 'yaw')", "yaw: got 0, expected 1 ± 0.1 (off by 1)"),
        (
            "check_angle_near({0, 6.5}, {0, 0}, 0.1, 'yaw')",
            "yaw: got 6.5, expected 0 ± 0.1 (off by 0.216815) at index 1",
        ),
        ("require_near(2, 1, 0.5, '100%')", "100%: got 2, expected 1 ± 0.5 (off by 1)"),
    ];
    for (call, text) in cases {
        let (answer, host) = run_body(&format!("rtf.{call}"));
        assert_eq!(answer, json!({"outcome": "failed"}));
        assert_eq!(host.texts(), [format!("failure: {text}")]);
    }
}

#[test]
fn a_comparison_that_holds_is_a_check_with_its_numbers() {
    let (answer, host) = run_body(
        "rtf.check_angle_near(3.1, -3.1, 0.1, 'heading') rtf.require_angle_near(9 * math.pi, math.pi, 1e-9, 'turns')",
    );
    assert_eq!(answer, json!({"outcome": "passed"}));
    assert_eq!(host.texts(), ["check: heading", "check: turns"]);
    let comparison = &host.all("message")[0]["comparison"];
    assert_eq!(*comparison, json!({"expected": [-3.1], "got": [3.1], "tolerance": 0.1}));
}

#[test]
fn numbers_that_json_cannot_carry_are_null() {
    let (_, host) = run_body(
        "rtf.check_near({1, 0/0}, {1, 2}, 0.1, 'pose') rtf.measure('rate', -1/0, 'Hz', 95)",
    );
    let comparison = &host.all("message")[0]["comparison"];
    assert_eq!(
        *comparison,
        json!({"expected": [1.0, 2.0], "got": [1.0, null], "tolerance": 0.1, "worst": 1})
    );
    assert_eq!(host.all("measured")[0]["value"], json!(null));
}

#[test]
fn wrong_use_is_an_error_at_the_line_that_does_it() {
    let cases = [
        (
            "rtf.check_near('a', 1, 0.1, 'x')",
            "what was got is neither a number nor a table of numbers: a",
        ),
        ("rtf.check_near(1, 1, -1, 'x')", "the tolerance -1 is not a finite number from 0"),
        ("rtf.measure('x', 'fast')", "the value of `x` is not a number: fast"),
        ("rtf.measure('x', 1, '', 0/0)", "the lower limit is not a number"),
        ("rtf.sleep('long')", "sleep takes seconds, not long"),
        ("rtf.attach('nowhere.csv')", "there is no file `"),
        ("rtf.attach('/dev')", "`/dev` cannot be attached: it is a directory, not a file"),
    ];
    for (line, text) in cases {
        let (answer, host) = run_body(line);
        assert_eq!(answer["outcome"], "error", "{line}");
        let message = host.all("message")[0];
        assert!(message["text"].as_str().unwrap().starts_with(text), "{message}");
        assert_eq!(message["location"]["line"], 2, "{line}");
    }
}

#[test]
fn a_measurement_has_a_place_unit_and_limits() {
    let (_, host) = run_body("rtf.report(rtf.measure('error', 0.02, 'rad', nil, 0.05))");
    let file = host.dir.path().join("plugin.lua");
    assert_eq!(
        *host.all("measured")[0],
        json!({"name": "error", "value": 0.02, "unit": "rad", "high": 0.05, "location": {"file": file, "line": 2}})
    );
    assert_eq!(host.texts(), ["report: true"]);
}

#[test]
fn a_message_names_the_line_of_the_plugin() {
    let (_, host) = run_body(
        "local function helper() rtf.check(true, 'in a helper')\nend\nhelper()\nrtf.report('here')",
    );
    let lines: Vec<_> = host.all("message").iter().map(|m| m["location"]["line"].clone()).collect();
    assert_eq!(lines, [2, 5]);
}

#[test]
fn texts_are_never_cut_and_need_not_be_texts() {
    let (_, host) = run_body(
        "rtf.report(('x'):rep(1 << 20)) rtf.report('a\\xFFb\\n2') rtf.report(nil) rtf.report(1.5)",
    );
    assert_eq!(host.texts()[0].len(), "report: ".len() + (1 << 20));
    assert_eq!(host.texts()[1..], ["report: a\u{FFFD}b\n2", "report: nil", "report: 1.5"]);
}

#[test]
fn a_file_is_attached_by_its_full_path() {
    let (_, host) =
        run_body("io.open('trace.csv', 'w'):close() rtf.attach('trace.csv', nil, 'text/csv')");
    let path = host.dir.path().join("trace.csv");
    assert_eq!(
        *host.all("attached")[0],
        json!({"name": "trace.csv", "path": path, "media_type": "text/csv"})
    );
}

#[test]
fn a_plugin_knows_its_name_and_parameters() {
    let (_, host) = run_body(
        "rtf.report(table.concat({rtf.name(), rtf.param(), rtf.environment(), rtf.repetition(), tostring(rtf.interrupted())}, '|'))",
    );
    assert_eq!(host.texts(), ["report: Arm|--rate 100|--robot sim|3|false"]);
}

#[test]
fn wait_until_names_what_it_waited_for_and_the_last_value() {
    let (answer, host) = run_body(
        "rtf.wait_until(function() return nil end, 0.05, 'the door to open') rtf.report('never')",
    );
    let text = "the door to open: not within 0.05 s (last value: nil)";
    assert_eq!(answer, json!({"outcome": "failed"}));
    assert_eq!(host.texts(), [format!("failure: {text}")]);
    assert_eq!(host.all("message")[0]["location"]["line"], 2);
    let (_, host) = run_body("rtf.report(rtf.wait_until(function() return 7 end, 0, 'nothing'))");
    assert_eq!(host.texts(), ["report: true"]);
}

#[test]
fn many_numbers_are_compared_in_words() {
    let (answer, host) = run_body(
        "local a, b = {}, {} for i = 1, 60000 do a[i], b[i] = i, i end a[60000] = 0\n\
         rtf.check_near(a, b, 0.5, 'image')",
    );
    assert_eq!(answer["outcome"], "failed");
    assert_eq!(
        host.texts(),
        ["failure: image: got 0, expected 60000 ± 0.5 (off by 60000) at index 59999"]
    );
    assert!(host.all("message")[0].get("comparison").is_none());
}

#[test]
fn texts_are_those_of_all_sdks() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../conformance/texts.json");
    let vectors: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let (mut calls, mut expected) = (String::new(), Vec::new());
    for case in vectors["comparisons"].as_array().unwrap() {
        let check = if case["angle"] == true { "check_angle_near" } else { "check_near" };
        let (got, wanted) = (lua(&case["got"]), lua(&case["expected"]));
        calls += &format!("rtf.{check}({got}, {wanted}, {}, 'x')\n", case["tolerance"]);
        expected.push(match case["problem"].as_str() {
            Some(problem) => format!("failure: x: {problem}"),
            None => "check: x".to_owned(),
        });
    }
    for case in vectors["numbers"].as_array().unwrap() {
        calls += &format!("rtf.check_near({}, 0.5, 0, 'x')\n", lua(&case[0]));
        expected.push(format!("failure: x: got {}, expected 0.5 ± 0", case[1].as_str().unwrap()));
    }
    let texts = run_body(&calls).1.texts();
    assert_eq!(texts.len(), expected.len());
    for (text, expected) in texts.iter().zip(&expected) {
        assert!(text.starts_with(expected.as_str()), "{text}, expected {expected}");
    }
}

/// A number of the vectors, or several, in Lua.
fn lua(value: &Value) -> String {
    match value {
        Value::Array(numbers) => {
            format!("{{{}}}", numbers.iter().map(lua).collect::<Vec<_>>().join(", "))
        }
        Value::String(name) => match name.as_str() {
            "inf" => "math.huge",
            "-inf" => "-math.huge",
            _ => "(0 / 0)",
        }
        .to_owned(),
        number => number.to_string(),
    }
}
