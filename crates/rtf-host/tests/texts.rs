//! The texts for violated limits, which only the runner composes.

use rtf_model::Measurement;
use serde_json::Value;

#[test]
fn violations_are_described_as_in_the_conformance_vectors() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../conformance/texts.json");
    let vectors: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    for case in vectors["limits"].as_array().unwrap() {
        let text = |field: &str| case[field].as_str().unwrap().to_owned();
        let measurement = Measurement {
            learned: false,
            name: text("name"),
            value: case["value"].as_f64(),
            unit: text("unit"),
            low: case["low"].as_f64(),
            high: case["high"].as_f64(),
            location: None,
            case: None,
        };
        assert_eq!(measurement.problem().as_deref(), case["problem"].as_str(), "{case}");
    }
}
