//! Attached files, logs, and what lies beside them.

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
