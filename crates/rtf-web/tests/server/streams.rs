//! Streams of events: live, resumed, filtered, and of clients that do not read.

use rtf_model::{MessageKind, Verdict};
use serde_json::json;

use crate::client::{Stream, get};
use crate::world::{TEST, World};

const EVENTS: &str = "/api/v1/runs/own/events";

#[test]
fn two_clients_see_everything_once_and_the_end() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.flush();
    let open = || Stream::open(world.address(), &format!("{EVENTS}?from=0"), &[]);
    let clients = [open(), open()];
    run.start(TEST);
    run.say(MessageKind::Report, "hello");
    run.finish(TEST, Verdict::Passed);
    run.end();
    let mut seen = clients.map(Stream::rest);
    assert_eq!(seen[0], seen[1]);
    let end = seen[0].pop().unwrap();
    assert_eq!((end.name.as_str(), end.id, &end.data), ("end", 8, &json!({"state": "finished"})));
    let ids: Vec<_> = seen[0].iter().map(|sent| (sent.name.as_str(), sent.id)).collect();
    assert_eq!(ids, (0..9).map(|id| ("message", id)).collect::<Vec<_>>());
    assert_eq!(seen[0][5].data["message"]["text"], "hello");
    let journal = get(world.address(), "/api/v1/runs/own/journal").text();
    let lines: Vec<serde_json::Value> =
        journal.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(seen[0].iter().map(|sent| sent.data.clone()).collect::<Vec<_>>(), lines);
}

#[test]
fn a_client_that_connects_again_goes_on_where_it_was() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.flush();
    let mut before = Stream::open(world.address(), &format!("{EVENTS}?from=2"), &[]);
    assert_eq!((before.next_event().id, before.next_event().id), (2, 3));
    drop(before);
    run.start(TEST);
    run.flush();
    // The header wins: a browser sends it with the address that it began with.
    let mut after =
        Stream::open(world.address(), &format!("{EVENTS}?from=2"), &["Last-Event-ID: 3"]);
    assert_eq!(after.next_event().id, 4);
    run.finish(TEST, Verdict::Passed);
    run.end();
    assert_eq!(after.rest().last().unwrap().name, "end");
    let over =
        crate::client::ask(world.address(), &format!("GET {EVENTS}"), &["Last-Event-ID: 7"], "");
    assert_eq!(over.status, 204, "nothing follows, and a browser stops asking");
}

#[test]
fn details_come_only_for_those_who_are_looked_at() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.start(TEST);
    run.print("noise");
    run.measure(1.0, 2.0);
    run.say(MessageKind::Report, "hello");
    run.finish(TEST, Verdict::Passed);
    run.flush();
    let ids = |details: &str, count: usize| -> Vec<u64> {
        let path = format!("{EVENTS}?from=4&details={details}");
        let mut stream = Stream::open(world.address(), &path, &[]);
        (0..count).map(|_| stream.next_event().id).collect()
    };
    assert_eq!(ids("none", 2), [4, 8]);
    assert_eq!(ids("fixture:0,test:1", 2), [4, 8]);
    assert_eq!(ids("fixture:0,test:0", 5), [4, 5, 6, 7, 8]);
    assert_eq!(ids("all", 5), [4, 5, 6, 7, 8]);
    assert_eq!(world.get(&format!("{EVENTS}?details=everything")).status, 400);
    let path = format!("{EVENTS}?from=5&details=none");
    let mut stream = Stream::open(world.address(), &path, &[]);
    assert_eq!(stream.next_event().id, 8);
    for _ in 0..3 {
        run.start(TEST);
        run.print("more noise");
        run.flush();
    }
    // It receives the progress, although no event is sent.
    let progress = std::iter::from_fn(|| stream.next()).find(|sent| sent.name == "progress");
    assert_eq!(progress.unwrap().data["seq"], 15);
}

/// It holds a connection, and neither the run nor the others wait for it.
#[test]
fn a_client_that_does_not_read_is_told_to_start_anew() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.start(TEST);
    run.flush();
    let mut lazy = Stream::open(world.address(), &format!("{EVENTS}?from=0"), &[]);
    assert_eq!(lazy.next_event().id, 0);
    let noise = "x".repeat(16 * 1024);
    for _ in 0..4096 {
        run.print(&noise);
    }
    run.finish(TEST, Verdict::Passed);
    run.flush();
    let mut other = Stream::open(world.address(), &format!("{EVENTS}?from=4100&details=none"), &[]);
    assert_eq!(other.next_event().data["type"], "test-finished");
    run.end();
    let seen = lazy.rest();
    assert_eq!(seen.last().unwrap().data, json!({"state": "finished"}));
    let (mut next, mut resyncs, mut came) = (1, 0, 0);
    for sent in &seen {
        match sent.name.as_str() {
            "resync" => (next, resyncs) = (sent.data["from"].as_u64().unwrap(), resyncs + 1),
            "message" => {
                assert_eq!(sent.id, next, "a gap is always told");
                (next, came) = (next + 1, came + 1);
            }
            _ => {}
        }
    }
    assert!(resyncs > 0 && came < 4096, "{came} of more than 4096 events came");
}

#[test]
fn a_client_from_the_future_and_one_at_a_gap_start_anew() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.flush();
    let mut future = Stream::open(world.address(), &format!("{EVENTS}?from=1000"), &[]);
    let resync = future.next_event();
    assert_eq!((resync.name.as_str(), &resync.data["from"]), ("resync", &json!(4)));
    run.start(TEST);
    run.flush();
    assert_eq!(future.next_event().id, 4);
    let journal = run.folder.join("events.jsonl");
    let text = std::fs::read_to_string(&journal).unwrap();
    let damaged = world.temp.path().join("damaged");
    std::fs::create_dir(&damaged).unwrap();
    let lines: Vec<_> = text.lines().enumerate().filter(|(line, _)| *line != 2).collect();
    let lines: String = lines.iter().map(|(_, line)| format!("{line}\n")).collect();
    std::fs::write(damaged.join("events.jsonl"), lines).unwrap();
    let info = world.get("/api/v1/runs/damaged").json();
    assert_eq!(info["damages"][0]["line"], 3, "{info}");
    let mut gap = Stream::open(world.address(), "/api/v1/runs/damaged/events?from=0", &[]);
    let names: Vec<_> = (0..5).map(|_| gap.next_event()).map(|sent| (sent.name, sent.id)).collect();
    let wanted = [("message", 0), ("message", 1), ("resync", 2), ("message", 3), ("message", 4)];
    assert_eq!(names, wanted.map(|(name, id)| (name.to_owned(), id)));
}

/// An open stream must not block axum's graceful shutdown.
#[test]
fn open_streams_do_not_keep_the_server() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.flush();
    let streams: Vec<_> =
        (0..3).map(|_| Stream::open(world.address(), &format!("{EVENTS}?from=0"), &[])).collect();
    run.start(TEST);
    run.finish(TEST, Verdict::Passed);
    run.end();
    let World { server, temp, .. } = world;
    server.stop().unwrap();
    for stream in streams {
        assert_eq!(stream.rest().last().unwrap().name, "end", "the last events came, too");
    }
    drop(temp);
}
