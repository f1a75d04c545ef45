//! Values of fixtures: in the snapshot, in the fixture and in the stream of events.

use rtf_model::{EventKind, FixtureId, FixturePlanned, FixtureProvided, SuiteId};
use serde_json::{Value, json};

use crate::client::Stream;
use crate::world::{World, Writer};

/// Text that would be executed if a page did not escape it.
const HOSTILE: &str = "</script><script>alert(1)</script>\n\u{1b}[31m";

#[test]
fn a_fixture_has_the_values_of_its_last_start() {
    let (world, mut run) = World::new();
    let fixture = FixtureId(0);
    let get = || world.get("/api/v1/runs/own/fixtures/0").json();
    let provide = |run: &mut Writer, name: &str, value: Option<Value>| {
        let (name, secret) = (name.to_owned(), value.is_none());
        run.emit(EventKind::FixtureProvided(FixtureProvided { fixture, name, value, secret }));
    };
    run.plan("arm", &["first"]);
    run.emit(EventKind::FixturePlanned(FixturePlanned {
        fixture,
        suite: SuiteId(0),
        name: "simulator".to_owned(),
        plugin_type: "process".to_owned(),
    }));
    run.emit(EventKind::FixtureStarting { fixture, attempt: 1 });
    run.flush();
    assert_eq!(get().get("values"), None, "nothing was provided yet");
    provide(&mut run, "port", Some(json!("40123")));
    provide(&mut run, "banner", Some(json!(HOSTILE)));
    provide(&mut run, "limits", Some(json!([-1.5, 2, {"joint": "elbow"}])));
    provide(&mut run, "token", None);
    run.flush();
    let values = json!([
        {"name": "port", "value": "40123"},
        {"name": "banner", "value": HOSTILE},
        {"name": "limits", "value": [-1.5, 2, {"joint": "elbow"}]},
        {"name": "token", "secret": true},
    ]);
    assert_eq!(get()["values"], values);
    let snapshot = world.get("/api/v1/runs/own/snapshot").json();
    assert_eq!(snapshot["fixtures"][0]["values"], values);
    run.emit(EventKind::FixtureStopping { fixture });
    run.emit(EventKind::FixtureStopped { fixture, problem: None, log_tail: Vec::new() });
    run.flush();
    assert_eq!(get()["values"], values, "they stay when it stops");
    run.emit(EventKind::FixtureStarting { fixture, attempt: 2 });
    run.flush();
    assert_eq!(get().get("values"), None, "a restarted fixture provides its values again");
}

/// Values are part of the stream for each client, with and without details.
#[test]
fn a_value_is_sent_as_it_is_provided() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.flush();
    let fixture = FixtureId(0);
    let mut client =
        Stream::open(world.address(), "/api/v1/runs/own/events?from=4&details=none", &[]);
    run.emit(EventKind::FixtureStarting { fixture, attempt: 1 });
    run.emit(EventKind::FixtureProvided(FixtureProvided {
        fixture,
        name: "port".to_owned(),
        value: Some(json!(40123)),
        secret: false,
    }));
    run.flush();
    let sent = [client.next_event(), client.next_event()].map(|sent| sent.data);
    assert_eq!(sent[0]["type"], "fixture-starting");
    assert_eq!((&sent[1]["name"], &sent[1]["value"]), (&json!("port"), &json!(40123)));
}
