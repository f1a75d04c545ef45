//! Attachments, logs, and other files in a run's directory.

use std::os::unix::fs::symlink;
use std::path::Path;

use rtf_model::Verdict;

use crate::client::ask;
use crate::world::{TEST, World};

const FILES: &str = "/api/v1/runs/own/files";

#[test]
fn attachments_are_shown_when_they_cannot_run_anything() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.start(TEST);
    run.attach("plot.png", b"\x89PNG");
    run.attach("evil.html", b"<script>alert(1)</script>");
    run.attach("evil.svg", b"<svg onload='alert(1)'/>");
    run.attach("a \"quote\" & 🤖%2e.txt", b"text");
    run.flush();
    let list = world.get("/api/v1/runs/own/tests/0/attempts/1/attachments").json();
    let urls: Vec<_> = list["attachments"].as_array().unwrap().iter().map(|a| &a["url"]).collect();
    let wanted = [
        ("image/png", "inline"),
        ("application/octet-stream", "attachment"),
        ("application/octet-stream", "attachment"),
        ("text/plain; charset=utf-8", "inline"),
    ];
    for (url, (kind, place)) in urls.iter().zip(wanted) {
        let answer = world.get(url.as_str().unwrap());
        assert_eq!(answer.status, 200, "{url}");
        assert_eq!(answer.header("content-type"), Some(kind), "{url}");
        assert!(answer.header("content-disposition").unwrap().starts_with(place), "{url}");
        let policy = answer.header("content-security-policy");
        assert_eq!(policy, Some("sandbox; default-src 'none'"), "{url}");
    }
    let part = ask(
        world.address(),
        &format!("GET {FILES}/attachments/plot.png"),
        &["Range: bytes=1-2"],
        "",
    );
    assert_eq!((part.status, part.body.as_slice()), (206, &b"PN"[..]));
    assert_eq!(part.header("content-range"), Some("bytes 1-2/4"));
}

#[test]
fn attachments_keep_the_type_and_the_name_that_the_test_gave() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.start(TEST);
    for (file, name, media_type, kind, saved) in [
        (
            "1-a",
            "forces",
            "text/csv",
            "text/csv; charset=utf-8",
            "inline; filename*=UTF-8''forces.csv",
        ),
        (
            "2-a",
            "state",
            "application/json",
            "application/json",
            "inline; filename*=UTF-8''state.json",
        ),
        ("3-a.dat", "clip", "video/mp4", "video/mp4", "inline; filename*=UTF-8''clip.dat"),
        ("4-a", "sound.ogg", "audio/ogg", "audio/ogg", "inline; filename*=UTF-8''sound.ogg"),
        (
            "5-a.png",
            "a/../b.png",
            "text/html",
            "application/octet-stream",
            "attachment; filename*=UTF-8''a%2F..%2Fb.png",
        ),
        (
            "6-a",
            "x",
            "bad\r\nX-Evil: 1",
            "application/octet-stream",
            "attachment; filename*=UTF-8''x",
        ),
    ] {
        run.attach_as(file, name, media_type, b"0123456789");
        run.flush();
        let answer = world.get(&format!("{FILES}/attachments/{file}"));
        assert_eq!(answer.header("content-type"), Some(kind), "{file}");
        assert_eq!(answer.header("content-disposition"), Some(saved), "{file}");
        assert_eq!(answer.header("x-evil"), None);
    }
}

/// A test may write any file to its run's directory.
#[test]
fn planted_links_and_pipes_lead_nowhere_and_hang_nothing() {
    let (world, mut run) = World::new();
    let secret = world.temp.path().join("secret");
    std::fs::create_dir(&secret).unwrap();
    std::fs::write(secret.join("x.log"), "secret").unwrap();
    std::fs::write(secret.join("events.jsonl"), "{}\n").unwrap();
    run.plan("arm", &["first"]);
    run.start(TEST);
    run.print("printed");
    run.attach("plot.png", b"png");
    run.attach("pipe", b"");
    run.flush();
    let log = "/api/v1/runs/own/logs/tests/0/1";
    assert_eq!(world.get(log).text(), "printed");
    let attachments = run.folder.join("attachments");
    replace_by_fifo(&attachments.join("pipe"));
    for _ in 0..8 {
        assert_eq!(world.get(&format!("{FILES}/attachments/pipe")).status, 404);
    }
    let logged = std::fs::read_dir(run.folder.join("logs")).unwrap().next().unwrap().unwrap();
    std::fs::remove_file(logged.path()).unwrap();
    symlink(secret.join("x.log"), logged.path()).unwrap();
    assert_eq!(world.get(log).status, 404, "a log that is a link");
    std::fs::rename(&attachments, run.folder.join("kept")).unwrap();
    symlink(&secret, &attachments).unwrap();
    assert_eq!(world.get(&format!("{FILES}/attachments/x.log")).status, 404, "a linked folder");
    for (name, plant) in [
        ("linked", &(|path: &Path| symlink(&secret, path).unwrap()) as &dyn Fn(&Path)),
        ("journal", &|path| {
            std::fs::create_dir(path).unwrap();
            symlink(secret.join("events.jsonl"), path.join("events.jsonl")).unwrap();
        }),
        ("pipe", &|path| {
            std::fs::create_dir(path).unwrap();
            replace_by_fifo(&path.join("events.jsonl"));
        }),
    ] {
        plant(&world.temp.path().join(name));
        for what in ["", "/snapshot", "/journal", "/events", "/files/x.log"] {
            assert_eq!(
                world.get(&format!("/api/v1/runs/{name}{what}")).status,
                404,
                "{name}{what}"
            );
        }
    }
    let runs = world.get("/api/v1/runs").json();
    let names: Vec<_> = runs["runs"].as_array().unwrap().iter().map(|run| &run["run"]).collect();
    assert_eq!(names, ["secret", "own"], "nothing else is a run");
}

fn replace_by_fifo(path: &Path) {
    drop(std::fs::remove_file(path));
    let made = std::process::Command::new("mkfifo").arg(path).status().unwrap();
    assert!(made.success());
}

#[test]
fn no_path_leads_out_of_the_attachments() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.start(TEST);
    run.attach("plot.png", b"png");
    run.flush();
    std::fs::write(world.temp.path().join("secret"), "secret").unwrap();
    std::os::unix::fs::symlink("../../secret", run.folder.join("attachments/link")).unwrap();
    for path in [
        "events.jsonl",
        "attachments/../events.jsonl",
        "attachments/%2e%2e/events.jsonl",
        "attachments%2f..%2fevents.jsonl",
        "attachments/..%2f..%2fsecret",
        "attachments/%2e%2e%2f%2e%2e%2fsecret",
        "attachments/..%5c..%5csecret",
        "attachments/%252e%252e/events.jsonl",
        "attachments/link",
        "attachments/",
        "attachments//plot.png",
        "attachments/plot.png%00",
        "%2fetc%2fpasswd",
        "/etc/passwd",
        "../../secret",
        "..%2f..%2fsecret",
    ] {
        let answer = world.get(&format!("{FILES}/{path}"));
        assert_eq!(answer.status, 404, "{path}");
    }
    for path in ["/../secret", "/%2e%2e/secret", "/assets/../../secret", "//etc/passwd"] {
        assert_eq!(world.get(path).status, 404, "{path}");
    }
}

#[test]
fn logs_come_whole_and_in_parts() {
    let (world, mut run) = World::new();
    run.plan("arm", &["a/../b"]);
    run.start(TEST);
    run.print("héllo ");
    run.print("<b>wörld</b>\n");
    run.finish(TEST, Verdict::Passed);
    run.flush();
    let path = "/api/v1/runs/own/logs/tests/0/1";
    let whole = world.get(path);
    assert_eq!(whole.text(), "héllo <b>wörld</b>\n");
    assert_eq!(whole.header("content-type"), Some("text/plain; charset=utf-8"));
    let (mut text, mut offset) = (String::new(), 0);
    loop {
        let part = world.get(&format!("{path}?offset={offset}&limit=4")).json();
        text += part["text"].as_str().unwrap();
        offset = part["next"].as_u64().unwrap();
        if part["next"] == part["size"] {
            break;
        }
    }
    assert_eq!(text, whole.text());
    for nothing in ["tests/0/2", "tests/0/0", "tests/9/1", "hooks/0/1", "fixtures/0/1", "x/0/1"] {
        assert_eq!(world.get(&format!("/api/v1/runs/own/logs/{nothing}")).status, 404, "{nothing}");
    }
}
