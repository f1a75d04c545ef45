//! The JSON Schema of a file of limits, for editors: `schemas/limits.json`.

use rtf_model::FindingSeverity;
use serde_json::{Map, Value, json};

use super::limit::Quantity;

/// Draft 7, which editors support best.
const DIALECT: &str = "http://json-schema.org/draft-07/schema#";

/// Returns the schema of a file of limits.
#[must_use]
pub fn json_schema() -> Value {
    let mut properties = part();
    properties.insert(
        "profiles".to_owned(),
        json!({
            "type": "object",
            "description": "For a profile of `rtf.toml`, what replaces values of the file; null removes an entry",
            "additionalProperties": { "$ref": "#/definitions/part" },
        }),
    );
    let mut schema = object(properties);
    schema["$schema"] = json!(DIALECT);
    schema["title"] = json!("Safety envelope");
    schema["description"] = json!("Limits of a robot, for suites of the Robot Testing Framework");
    schema["definitions"] = json!({
        "bound": {
            "type": ["number", "string"],
            "description": "A number, with or without a unit: `1.05rad`",
        },
        "duration": {
            "type": ["number", "string"],
            "description": "A duration: `80ms`, or a number of seconds",
        },
        "joint": object(quantities(|quantity| {
            let name = if quantity.is_magnitude() { "magnitude" } else { "limit" };
            json!({ "anyOf": [{ "$ref": format!("#/definitions/{name}") }, { "type": "null" }] })
        })),
        "limit": limit(false),
        "magnitude": limit(true),
        "part": object(part()),
        "severity": {
            "type": "string",
            "enum": FindingSeverity::ALL.map(|(word, _)| word),
            "description": "What a violation means",
        },
    });
    schema
}

fn part() -> Map<String, Value> {
    let text = |description: &str| json!({ "type": "string", "description": description });
    let properties = [
        ("robot", text("Precedes the names of the monitors")),
        ("model", text("A URDF or MJCF, relative to this file, with further limits")),
        ("severity", json!({ "$ref": "#/definitions/severity" })),
        (
            "factor",
            json!({
                "type": "number",
                "exclusiveMinimum": 0,
                "maximum": 1,
                "description": "Tightens all limits",
            }),
        ),
        (
            "signals",
            object(quantities(|quantity| {
                let or_rate = if quantity.integral().is_some() { ", or `rate`" } else { "" };
                text(&format!("The name of the signal, with `{{joint}}`{or_rate}"))
            })),
        ),
        (
            "ignore",
            json!({
                "type": "array",
                "items": { "type": "string" },
                "description": "Joints of the model without limits",
            }),
        ),
        (
            "joints",
            json!({
                "type": "object",
                "description": "The limits of each joint",
                "additionalProperties": {
                    "anyOf": [{ "$ref": "#/definitions/joint" }, { "type": "null" }],
                },
            }),
        ),
        (
            "limits",
            json!({
                "type": "object",
                "description": "Limits of other signals by name",
                "additionalProperties": {
                    "anyOf": [{ "$ref": "#/definitions/limit" }, { "type": "null" }],
                },
            }),
        ),
    ];
    properties.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

fn quantities(value: impl Fn(Quantity) -> Value) -> Map<String, Value> {
    Quantity::ALL.iter().map(|it| (it.name().to_owned(), value(*it))).collect()
}

fn limit(is_magnitude: bool) -> Value {
    let mut properties = Map::new();
    let text = |description: &str| json!({ "type": "string", "description": description });
    properties.insert("signal".to_owned(), text("The signal that is limited"));
    properties.insert("rate-of".to_owned(), text("The signal whose slope is limited"));
    for side in if is_magnitude { &["max"][..] } else { &["min", "max"] } {
        properties.insert((*side).to_owned(), json!({ "$ref": "#/definitions/bound" }));
    }
    properties.insert("for".to_owned(), json!({ "$ref": "#/definitions/duration" }));
    properties.insert("severity".to_owned(), json!({ "$ref": "#/definitions/severity" }));
    object(properties)
}

fn object(properties: Map<String, Value>) -> Value {
    json!({ "type": "object", "additionalProperties": false, "properties": properties })
}
