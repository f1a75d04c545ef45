//! The record as a trace of OpenTelemetry.

use std::collections::{BTreeMap, HashMap, HashSet};

use rtf_report::otlp;
use serde_json::Value;

use crate::support::*;

fn trace(name: &str) -> Value {
    let mut bytes = Vec::new();
    otlp::write(&mut bytes, &record(name)).unwrap();
    serde_json::from_slice(&bytes).unwrap()
}

fn spans(trace: &Value) -> &Vec<Value> {
    trace["resourceSpans"][0]["scopeSpans"][0]["spans"].as_array().unwrap()
}

/// The value with the fields of objects in alphabetical order: that of `serde_json` depends
/// on the features that other crates of a build select.
fn sorted(value: &Value) -> Value {
    match value {
        Value::Object(fields) => {
            let fields: BTreeMap<_, _> = fields.iter().collect();
            fields.into_iter().map(|(name, value)| (name.clone(), sorted(value))).collect()
        }
        Value::Array(values) => values.iter().map(sorted).collect(),
        other => other.clone(),
    }
}

fn nanos(span: &Value, field: &str) -> u64 {
    span[field].as_str().unwrap().parse().unwrap()
}

#[test]
fn traces() {
    for name in ["cases", "collapse-restart", "measured"] {
        let trace = trace(name);
        let lines: Vec<_> = spans(&trace).iter().map(|span| sorted(span).to_string()).collect();
        insta::assert_snapshot!(format!("otlp-{name}"), lines.join("\n"));
    }
}

#[test]
fn every_span_is_in_its_parent_and_the_ids_are_valid() {
    for name in names().into_iter().filter(|name| record(name).run.is_some()) {
        let trace = trace(&name);
        let by_id: HashMap<_, _> = spans(&trace).iter().map(|it| (&it["spanId"], it)).collect();
        assert_eq!(by_id.len(), spans(&trace).len(), "{name}: ids are unique");
        let traces: HashSet<_> = spans(&trace).iter().map(|it| &it["traceId"]).collect();
        let id = traces.iter().next().unwrap().as_str().unwrap();
        assert_eq!((traces.len(), id.len()), (1, 32), "{name}: {id}");
        for (number, span) in spans(&trace).iter().enumerate() {
            let (start, end) = (nanos(span, "startTimeUnixNano"), nanos(span, "endTimeUnixNano"));
            assert!(start <= end, "{name}: {span}");
            let Some(parent) = span.get("parentSpanId") else {
                assert_eq!(number, 0, "{name}: only the run has no parent");
                continue;
            };
            let parent = by_id[parent];
            assert!(nanos(parent, "startTimeUnixNano") <= start, "{name}: {span}");
        }
    }
}

#[test]
fn the_status_of_a_span_is_that_of_its_verdict() {
    let trace = trace("verdicts");
    let text = |span: &Value, key: &str| {
        let attributes = span["attributes"].as_array().unwrap();
        let found = attributes.iter().find(|it| it["key"] == key);
        found.map(|it| it["value"]["stringValue"].as_str().unwrap().to_owned())
    };
    let mut seen = HashSet::new();
    for span in spans(&trace) {
        let Some(verdict) = text(span, "rtf.verdict") else { continue };
        let expected = match verdict.as_str() {
            "passed" => (Some(1), Some("pass")),
            "skipped" => (None, None),
            "interrupted" => (Some(2), None),
            _ => (Some(2), Some("fail")),
        };
        let status = text(span, "test.case.result.status");
        assert_eq!((span["status"]["code"].as_u64(), status.as_deref()), expected, "{verdict}");
        seen.insert(verdict);
    }
    assert!(seen.len() >= 5, "{seen:?}");
}
