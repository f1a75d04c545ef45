//! The JSON Schema of `rtf.toml`, for editors: `schemas/config.json`.
//!
//! It accepts the values that `spec/config.md` specifies. `rtf` itself checks more: filters,
//! durations, names of variables, and whether a profile exists.

use serde_json::{Map, Value, json};

use super::keys::{KEYS, Key, NameKind, REPORTS, ValueFormat};
use super::quarantine;

/// Draft 7, which editors support best.
const DIALECT: &str = "http://json-schema.org/draft-07/schema#";

/// Verdicts that a quarantine can cover.
const VERDICTS: [&str; 5] = ["failed", "error", "crashed", "timed-out", "collapsed"];

/// Returns the schema of an `rtf.toml`.
#[must_use]
pub fn json_schema() -> Value {
    let mut properties = layer();
    properties.insert(
        "default-profile".to_owned(),
        described(
            json!({"type": "string"}),
            "Profile that applies if neither --profile nor RTF_PROFILE is given",
        ),
    );
    properties.insert(
        "profile".to_owned(),
        json!({
            "type": "object",
            "description": "Profiles, which override the settings at the top level",
            "additionalProperties": { "$ref": "#/definitions/profile" },
        }),
    );
    let mut schema = object(properties);
    schema["$schema"] = json!(DIALECT);
    schema["title"] = json!("rtf.toml");
    schema["description"] =
        json!("Settings of the Robot Testing Framework for all suites below a directory");
    let mut profile = object(layer());
    profile["description"] = json!("Settings of a profile");
    schema["definitions"] = json!({
        "duration": duration(),
        "history": table("history"),
        "profile": profile,
        "quarantine": quarantine_table(),
        "scalar": { "type": ["string", "number", "boolean"] },
        "timeouts": table("timeouts"),
    });
    schema
}

/// The keys that are allowed at the top level and in a profile.
fn layer() -> Map<String, Value> {
    let mut properties = properties(KEYS);
    properties.insert(
        quarantine::QUARANTINE.to_owned(),
        json!({
            "type": "array",
            "description": "Known failures of all tests that match a filter",
            "minItems": 1,
            "items": { "$ref": "#/definitions/quarantine" },
        }),
    );
    properties
}

/// The schema of a table of keys.
fn table(name: &str) -> Value {
    let keys = KEYS.iter().find_map(|key| match key.format {
        ValueFormat::Table(keys) if key.name == name => Some(keys),
        _ => None,
    });
    object(properties(keys.unwrap_or_default()))
}

fn properties(keys: &[Key]) -> Map<String, Value> {
    let property = |key: &Key| (key.name.to_owned(), described(value(key), key.summary));
    keys.iter().map(property).collect()
}

fn object(properties: Map<String, Value>) -> Value {
    json!({ "type": "object", "additionalProperties": false, "properties": properties })
}

/// Adds a description. Draft 7 ignores everything next to a reference.
fn described(mut value: Value, description: &str) -> Value {
    if value.get("$ref").is_some() {
        value = json!({ "allOf": [value] });
    }
    value["description"] = json!(description);
    value
}

fn value(key: &Key) -> Value {
    match key.format {
        ValueFormat::Text => json!({ "type": "string" }),
        ValueFormat::Path => json!({ "type": "string", "minLength": 1 }),
        ValueFormat::Reports => {
            let pattern = format!("^({})=.", REPORTS.join("|"));
            json!({ "type": "array", "items": { "type": "string", "pattern": pattern } })
        }
        ValueFormat::Duration => json!({ "$ref": "#/definitions/duration" }),
        ValueFormat::Scale => json!({ "type": "number", "exclusiveMinimum": 0, "maximum": 1000 }),
        ValueFormat::Count(least, most) => {
            json!({ "type": "integer", "minimum": least, "maximum": most })
        }
        ValueFormat::Boolean => json!({ "type": "boolean" }),
        ValueFormat::Words(words) => json!({ "type": "string", "enum": words }),
        ValueFormat::Named(names) => named(names),
        ValueFormat::Table(_) => json!({ "$ref": format!("#/definitions/{}", key.name) }),
    }
}

fn named(names: NameKind) -> Value {
    let pattern = match names {
        NameKind::Variables => "^[^=]+$",
        NameKind::Parameters => "^[A-Za-z][A-Za-z0-9_-]*$",
    };
    json!({
        "type": "object",
        "propertyNames": { "pattern": pattern },
        "additionalProperties": { "$ref": "#/definitions/scalar" },
    })
}

fn duration() -> Value {
    json!({
        "description": "A duration: `\"250ms\"`, `\"2min\"`, or a number of seconds",
        "anyOf": [
            { "type": "string", "minLength": 1 },
            { "type": "number", "exclusiveMinimum": 0 },
        ],
    })
}

fn quarantine_table() -> Value {
    let properties = quarantine::KEYS.iter().map(|key| {
        let (value, description) = match *key {
            "filter" => (json!({ "type": "string", "minLength": 1 }), "Tests that it applies to"),
            "until" => (
                json!({ "type": "string", "pattern": "^\\d{4}-\\d{2}-\\d{2}$" }),
                "Last day on which it applies",
            ),
            "verdicts" => (
                json!({
                    "type": "array",
                    "minItems": 1,
                    "items": { "type": "string", "enum": VERDICTS },
                }),
                "Verdicts that it covers, by default `failed`",
            ),
            "issue" => (json!({ "type": "string" }), "Issue, for reports"),
            _ => (json!({ "type": "string" }), "Reason, for reports"),
        };
        ((*key).to_owned(), described(value, description))
    });
    let mut table = object(properties.collect());
    table["required"] = json!(["filter"]);
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_a_file_has_a_property() {
        let schema = json_schema();
        for key in KEYS {
            let property = &schema["properties"][key.name];
            assert_eq!(property["description"], key.summary, "{}", key.name);
            assert_eq!(property, &schema["definitions"]["profile"]["properties"][key.name]);
        }
        for key in quarantine::KEYS {
            assert!(schema["definitions"]["quarantine"]["properties"].get(key).is_some(), "{key}");
        }
    }
}
