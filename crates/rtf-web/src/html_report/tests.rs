use std::fs;
use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::GzDecoder;
use rtf_report::Reporter;
use rtf_report::journal::Journal;
use serde_json::Value;

use super::*;

const STREAMS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../rtf-report/tests/streams");

fn report(journal: &Path, output: Option<&Path>) -> String {
    let template = Template::split("<html>\n<!--rtf-data--></html>").unwrap();
    let rerun =
        Box::new(|_: &rtf_model::Record, test, _: Option<&str>| Some(format!("rtf run {test}")));
    let commands = &TestCommands::without_replay(rerun);
    let mut out = Vec::new();
    fill(&template, &mut out, &ReportSource { journal, output, commands, dir: None }).unwrap();
    String::from_utf8(out).unwrap()
}

/// The blocks of a report: names and JSON.
fn blocks(html: &str) -> BTreeMap<String, Value> {
    let body = html.strip_prefix("<html>\n").and_then(|rest| rest.strip_suffix("</html>")).unwrap();
    let block = |line: &str| {
        let rest = line.strip_prefix("<script type=\"application/gzip\" id=\"rtf-").unwrap();
        let (name, data) = rest.strip_suffix("</script>").unwrap().split_once("\">").unwrap();
        let data = STANDARD.decode(data).unwrap();
        let json = serde_json::from_reader(GzDecoder::new(&*data)).unwrap();
        (name.to_owned(), json)
    };
    body.lines().map(block).collect()
}

fn stream(name: &str) -> BTreeMap<String, Value> {
    blocks(&report(&Path::new(STREAMS).join(format!("{name}.jsonl")), None))
}

/// A journal with these lines in a run directory.
fn run_dir(lines: &[&str]) -> (tempfile::TempDir, std::path::PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    fs::create_dir_all(dir.path().join("run/attachments")).unwrap();
    let journal = dir.path().join("run/events.jsonl");
    fs::write(&journal, format!("{}\n", lines.join("\n"))).unwrap();
    (dir, journal)
}

#[test]
fn every_stored_run_is_complete_and_reproducible() {
    for file in fs::read_dir(STREAMS).unwrap() {
        let path = file.unwrap().path();
        let html = report(&path, None);
        assert_eq!(html, report(&path, None), "{}", path.display());
        let all = blocks(&html);
        let overview = &all["overview"];
        assert_eq!(overview["format"], 1);
        let tests = overview["snapshot"]["tests"].as_array().unwrap();
        for test in tests {
            let place = |key: &str| &all[&overview["places"][key].to_string()][key];
            let key = format!("tests/{}", test["id"]);
            assert_eq!(&place(&key)["test"], test, "{}", path.display());
            for attempt in test["attempts"].as_array().unwrap() {
                let key = format!("{key}/{}", attempt["number"]);
                assert!(place(&key).is_object(), "{} in {}", key, path.display());
            }
        }
    }
}

#[test]
fn signals() {
    // The order of `Value` depends on the features of `serde_json`.
    insta::with_settings!({sort_maps => true}, {
        insta::assert_json_snapshot!("signals", stream("sampled"));
    });
}

#[test]
fn details_belong_to_their_attempts() {
    let all = stream("collapse-restart");
    let places = all["overview"]["places"].as_object().unwrap();
    let keys: Vec<_> = places.keys().filter(|key| key.matches('/').count() == 2).collect();
    insta::assert_snapshot!(format!("{keys:?}"));
    let chunk = &all["0"];
    for (key, details) in chunk.as_object().unwrap() {
        let is_test = key.starts_with("tests/");
        assert!(is_test || details.get("series").is_none(), "{key} has signals");
    }
}

#[test]
fn a_run_that_goes_on_is_incomplete() {
    let text = fs::read_to_string(Path::new(STREAMS).join("silent.jsonl")).unwrap();
    let dir = tempfile::tempdir().unwrap();
    let journal = dir.path().join("events.jsonl");
    let mut writer = Journal::create(&journal).unwrap();
    for line in text.lines().take(5) {
        writer.event(&serde_json::from_str(line).unwrap(), &rtf_model::Record::default()).unwrap();
    }
    writer.idle(&rtf_model::Record::default()).unwrap();
    let info = &blocks(&report(&journal, None))["overview"]["snapshot"]["info"];
    assert_eq!((&info["state"], &info["green"]), (&"incomplete".into(), &false.into()));
}

const STARTED: &str =
    r#"{"seq":0,"at":0,"type":"test-started","test":0,"repetition":1,"attempt":1}"#;

fn attached(path: &str) -> String {
    format!(
        r#"{{"seq":1,"at":1,"type":"attached","test":0,"attachment":{{"name":"n","path":"{path}","media_type":"text/html"}}}}"#
    )
}

fn url(html: &str) -> String {
    let details = &blocks(html)["0"]["tests/0/1"];
    details["attachments"][0]["url"].as_str().unwrap().to_owned()
}

#[test]
fn small_attachments_are_embedded_and_large_ones_copied() {
    let (dir, journal) = run_dir(&[STARTED, &attached("attachments/a b.html")]);
    let file = dir.path().join("run/attachments/a b.html");
    fs::write(&file, "<script>").unwrap();
    let output = dir.path().join("out/report.html");
    let html = report(&journal, Some(&output));
    assert_eq!(url(&html), "data:application/octet-stream;base64,PHNjcmlwdD4=");
    assert!(!output.with_file_name("report_files").exists());

    fs::write(&file, vec![b'x'; (512 << 10) + 1]).unwrap();
    assert_eq!(url(&report(&journal, Some(&output))), "report_files/a%20b.html");
    let copy = output.with_file_name("report_files").join("a b.html");
    assert_eq!(fs::metadata(copy).unwrap().len(), (512 << 10) + 1);
    let inside = dir.path().join("run/report.html");
    assert_eq!(url(&report(&journal, Some(&inside))), "attachments/a%20b.html");
    assert_eq!(url(&report(&journal, None)), "");
    assert_eq!(url(&report(&journal, Some(Path::new("/dev/stdout")))), "");
}

#[test]
fn nothing_outside_of_the_attachments_is_in_a_report() {
    for path in ["../secret", "attachments/../../secret", "/etc/hostname", "attachments/link"] {
        let (dir, journal) = run_dir(&[STARTED, &attached(path)]);
        let secret = dir.path().join("secret");
        fs::write(&secret, "secret").unwrap();
        std::os::unix::fs::symlink(&secret, dir.path().join("run/attachments/link")).unwrap();
        let output = dir.path().join("report.html");
        assert_eq!(url(&report(&journal, Some(&output))), "", "{path}");
    }
}

#[test]
fn long_lists_are_excerpts_with_numbers() {
    let mut lines = vec![STARTED.to_owned()];
    for seq in 1..=6000 {
        let kind = if seq == 3000 { "failure" } else { "report" };
        lines.push(format!(
            r#"{{"seq":{seq},"at":1,"type":"message","source":{{"test":0}},"message":{{"kind":"{kind}","text":"{seq}"}}}}"#
        ));
    }
    for seq in 6001..=6010 {
        let text = "x".repeat(64 << 10);
        lines.push(format!(
            r#"{{"seq":{seq},"at":1,"type":"output","source":{{"test":0}},"stream":"stdout","text":"{text}"}}"#
        ));
    }
    let lines: Vec<_> = lines.iter().map(String::as_str).collect();
    let (_dir, journal) = run_dir(&lines);
    let details = &blocks(&report(&journal, None))["0"]["tests/0/1"];
    let seqs = |list: &str| -> Vec<_> {
        let entries = details[list].as_array().unwrap().iter();
        entries.map(|entry| entry["seq"].as_u64().unwrap()).collect()
    };
    let wanted: Vec<_> = (1..=2000).chain([3000]).chain(4001..=6000).collect();
    assert_eq!(seqs("messages"), wanted);
    assert_eq!(details["omitted"]["messages"], 1999);
    assert_eq!(seqs("output"), [6001, 6002, 6009, 6010]);
    assert_eq!(details["output"][2]["omitted_bytes"], 6 * (64 << 10));
}

#[test]
fn a_page_has_one_place_for_data() {
    for page in ["", "<html></html>", "<!--rtf-data--><!--rtf-data-->"] {
        assert!(Template::split(page).is_none(), "{page}");
    }
}

/// What an attempt reports may contain the names of blocks, and of their element.
#[test]
fn no_text_of_a_plug_in_is_markup() {
    let path = Path::new(STREAMS).join("nasty.jsonl");
    let html = report(&path, None);
    let mut text = String::new();
    for line in html.lines().filter(|line| line.starts_with("<script")) {
        let data = line.split_once('>').and_then(|(_, rest)| rest.strip_suffix("</script>"));
        let data = STANDARD.decode(data.unwrap()).unwrap();
        GzDecoder::new(&*data).read_to_string(&mut text).unwrap();
    }
    assert!(text.contains("<&>"), "the stream contains markup");
    let tags = html.matches('<').count();
    assert_eq!(tags, 2 * blocks(&html).len() + 2, "only the blocks have tags");
}
