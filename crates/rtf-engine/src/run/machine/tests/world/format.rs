//! Formats events and effects as lines of the transcript.

use std::collections::BTreeMap;

use crate::run::machine::{Effect, SignalReach};

pub fn line_of(json: &serde_json::Value) -> String {
    let mut line = json["type"].as_str().unwrap_or_default().to_owned();
    // The order of the map depends on serde_json's features in the workspace.
    let fields: BTreeMap<_, _> = json.as_object().unwrap().iter().collect();
    for (key, value) in fields {
        if !["type", "suite", "log_tail", "message"].contains(&key.as_str()) {
            let text = text_of(value);
            line += &format!(" {key}={text}");
        }
    }
    line
}

fn text_of(value: &serde_json::Value) -> String {
    sorted(value).to_string().replace('"', "")
}

fn sorted(value: &serde_json::Value) -> serde_json::Value {
    let Some(object) = value.as_object() else { return value.clone() };
    let fields: BTreeMap<_, _> = object.iter().map(|(key, value)| (key, sorted(value))).collect();
    fields.into_iter().map(|(key, value)| (key.clone(), value)).collect()
}

pub fn effect_of(effect: &Effect) -> String {
    match effect {
        Effect::CloseChannel(_) => "→ close the channel".to_owned(),
        Effect::DumpStack(..) => "→ take a stack dump".to_owned(),
        Effect::Signal(_, signal, SignalReach::Group) => format!("→ signal {signal}"),
        Effect::Signal(_, signal, reach) => {
            format!("→ signal {signal} to {reach:?}").to_lowercase()
        }
        Effect::KillTree(_) => "→ kill the tree".to_owned(),
        other => format!("→ {other:?}"),
    }
}
