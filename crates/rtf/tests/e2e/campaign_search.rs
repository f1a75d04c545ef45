//! Episodes that are found while others run: `rtf campaign shrink` and `rtf campaign search`.

use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{ChildStdin, ChildStdout, Stdio};

use insta::assert_snapshot;
use serde_json::{Value, json};

use crate::ended_campaigns::first_child;
use crate::support::{Finished, Folder, Running, kill, nothing_left, wait_until};

/// Fails with a heavy payload on ice. The log has a line for each start of the simulator.
const GRASP: &str = "TestCase = {}\nfunction TestCase.run()\n  \
    local payload = tonumber(os.getenv('RTF_PARAM_PAYLOAD'))\n  \
    if payload == 1.5 then io.open('runs', 'a'):write('run\\n'):close(); rtf.sleep(1) end\n  \
    local is_ice = os.getenv('RTF_PARAM_SURFACE') == 'ice'\n  \
    rtf.check(payload < 2 or not is_ice, 'it slips')\nend\n";
const SUITE: &str = "<suite name='grasp'>\
    <fixture name='sim' type='process'>\
      <command>sh -c 'echo start >> log; echo up; exec sleep 1000'</command>\
      <ready log='up'/><reset command='true'/>\
    </fixture>\
    <test>Grasp.lua</test></suite>";
const CAMPAIGN: &str = "<campaign suite='grasp.xml' episodes='40' seed='2'>\
    <parameter name='payload' distribution='uniform' low='0' high='2.5' nominal='1'/>\
    <parameter name='friction' distribution='normal' mean='0.8' deviation='0.1'/>\
    <parameter name='surface' distribution='choice' values='wood ice'/>\
    <constraint require='payload &lt; 5'/>\
    <claim require='rate >= 0.5' confidence='0.95'/></campaign>";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("Grasp.lua", GRASP).file("grasp.xml", SUITE).file("campaign.xml", CAMPAIGN);
    folder
}

fn starts(folder: &Folder) -> usize {
    folder.read("log").lines().count()
}

#[test]
fn the_smallest_failing_change_is_found() {
    let folder = folder();
    assert_eq!(folder.rtf(&["campaign", "run", "campaign.xml", "-w", "2"]).code, Some(0));
    let results = folder.read("rtf-results/campaigns/latest/results.jsonl");
    let failed = results.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    let failed = failed.filter(|line| line["outcome"] == "failed").collect::<Vec<_>>();
    let id = failed.first().expect("one fails")["episode"].to_string();
    let before = starts(&folder);
    let finished = folder.rtf(&["campaign", "shrink", &id]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let begin = finished.stdout.find("the smallest").expect("a result");
    let result = finished.stdout[begin..].split(" (").next().unwrap_or_default();
    assert_eq!(result, "the smallest change from the nominal parameters that fails");
    let values: Vec<_> = finished.stdout[begin..].lines().skip(1).take(2).collect();
    assert_eq!(values[1], "  surface=ice  nominal wood");
    assert!(values[0].starts_with("  payload=2"), "{values:?}");
    assert_eq!(starts(&folder), before + 1, "the simulator stays up");
    let again = finished.stdout.lines().last().and_then(|line| line.strip_prefix("repeat: rtf "));
    let again: Vec<_> = again.expect("a command").split(' ').collect();
    assert_eq!(folder.rtf(&again).code, Some(1), "{again:?}");
    let json = folder.rtf(&["campaign", "shrink", &id, "campaign.xml", "--format", "json"]);
    let json: Value = serde_json::from_str(&json.stdout).expect("JSON");
    assert_eq!(json["changes"][1]["value"], "ice");
    assert_eq!(json["parameters"]["friction"], "0.8");
    assert!(nothing_left(&folder));
}

#[test]
fn episodes_that_cannot_be_shrunk() {
    let folder = folder();
    let episodes = folder.rtf(&["campaign", "episodes", "campaign.xml"]).stdout;
    let wood = episodes.lines().position(|line| line.contains("wood")).expect("one has wood") + 1;
    let finished = folder.rtf(&["campaign", "shrink", &wood.to_string(), "campaign.xml"]);
    assert_eq!(finished.code, Some(2));
    assert!(finished.stderr.contains("does not fail when it runs again"), "{}", finished.stderr);
    let finished = folder.rtf(&["campaign", "shrink", "41", "campaign.xml"]);
    assert_eq!(finished.code, Some(2));
    assert_snapshot!(folder.shown(&finished), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: `campaign.xml` has no episode 41
    hint: its episodes are 1 to 40
    ");
    folder.file("Grasp.lua", "TestCase = {}\nfunction TestCase.run() rtf.fail('always') end\n");
    let finished = folder.rtf(&["campaign", "shrink", "1", "campaign.xml"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stderr);
    let expected = "\nit fails with all parameters being nominal (2 runs)\n";
    assert!(finished.stdout.contains(expected), "{}", finished.stdout);
}

/// `rtf campaign search`, and its standard input and output.
struct Search {
    running: Running,
    questions: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Search {
    fn start(folder: &Folder, more: &[&str]) -> (Self, Value) {
        let mut command = folder.command(&[&["campaign", "search", "campaign.xml"], more].concat());
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("rtf starts");
        let questions = child.stdin.take();
        let answers = BufReader::new(child.stdout.take().expect("a pipe"));
        let mut search = Self { running: folder.watch(child), questions, answers };
        let header = search.read();
        (search, header)
    }

    fn write(&mut self, line: &str) {
        let questions = self.questions.as_mut().expect("it is open");
        writeln!(questions, "{line}").expect("rtf reads");
    }

    fn read(&mut self) -> Value {
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("a line");
        serde_json::from_str(&line).unwrap_or_else(|error| panic!("{error}: {line}"))
    }

    fn ask(&mut self, question: &Value) -> Value {
        self.write(&question.to_string());
        self.read()
    }

    fn finish(mut self) -> Finished {
        self.questions = None;
        self.running.finish()
    }
}

#[test]
fn another_program_asks_for_episodes() {
    let folder = folder();
    let (mut search, header) = Search::start(&folder, &[]);
    let names: Vec<_> = header["parameters"].as_array().expect("a list").iter().collect();
    assert_eq!(*names[0], json!({"name": "payload", "low": 0.0, "high": 2.5, "nominal": "1"}));
    assert_eq!(*names[2], json!({"name": "surface", "values": ["wood", "ice"], "nominal": "wood"}));
    let heavy = search.ask(&json!({"parameters": {"payload": 2.25, "surface": "ice"}, "seed": 3}));
    assert_eq!(
        (&heavy["outcome"], &heavy["ask"], &heavy["seed"]),
        (&json!("failed"), &json!(1), &json!(3))
    );
    assert_eq!(
        heavy["parameters"],
        json!({"payload": "2.25", "friction": "0.8", "surface": "ice"})
    );
    assert_eq!(search.ask(&json!({}))["outcome"], "passed");
    let problems = [
        (json!({"parameters": {"mass": 1}}), "the campaign has no parameter `mass`"),
        (json!({"parameters": {"payload": [1]}}), "`payload` is not a text or a number"),
        (
            json!({"parameters": {"payload": 7}}),
            "the parameters violate a constraint of the campaign",
        ),
        (json!({"seed": 2_147_483_648u32}), "`seed` is at most 2147483647"),
        (
            json!({"sed": 1}),
            "unknown field `sed`, expected `parameters` or `seed` at line 1 column 6",
        ),
    ];
    for (question, problem) in problems {
        assert_eq!(search.ask(&question)["error"], problem);
    }
    let finished = search.finish();
    assert_eq!((finished.code, starts(&folder)), (Some(0), 1), "{}", finished.stderr);
    let again = folder.rtf(&["run", "--episode", "1", "rtf-results/searches/latest"]);
    assert_eq!(again.code, Some(1), "{}", again.stdout);
    let refused = folder.rtf(&["campaign", "show", "rtf-results/searches/latest"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("is the directory of a search"), "{}", refused.stderr);
    assert!(nothing_left(&folder));
}

#[test]
fn several_episodes_at_once_and_the_end_of_the_input() {
    let folder = folder();
    let (mut search, _) = Search::start(&folder, &["--workers", "2"]);
    for payload in 0..6 {
        search.write(&json!({"parameters": {"payload": f64::from(payload) / 2.0}}).to_string());
    }
    search.questions = None;
    let mut asks: Vec<_> = (0..6).map(|_| search.read()["ask"].as_u64()).collect();
    asks.sort_unstable();
    assert_eq!(asks, (1..=6).map(Some).collect::<Vec<_>>());
    assert_eq!((search.finish().code, starts(&folder)), (Some(0), 2));
    assert!(nothing_left(&folder));
}

/// The episode runs again on a new worker.
#[test]
fn the_death_of_a_worker_is_not_the_result_of_an_episode() {
    let folder = folder();
    let (mut search, _) = Search::start(&folder, &[]);
    assert_eq!(search.ask(&json!({}))["outcome"], "passed");
    search.write(&json!({"parameters": {"payload": 1.5}}).to_string());
    wait_until("the episode", || folder.path().join("runs").exists().then_some(()));
    let guard = first_child(search.running.child.id()).expect("the guard of the worker");
    assert!(kill(first_child(guard).expect("the runner")));
    assert_eq!(search.read()["outcome"], "passed");
    assert_eq!(folder.read("runs").lines().count(), 2);
    assert_eq!(search.finish().code, Some(0));
    assert!(nothing_left(&folder));
}

#[test]
fn a_signal_ends_a_search() {
    let folder = folder();
    let (mut search, _) = Search::start(&folder, &[]);
    assert_eq!(search.ask(&json!({}))["outcome"], "passed");
    search.write(&json!({"parameters": {"payload": 1.5}}).to_string());
    wait_until("the episode", || folder.path().join("runs").exists().then_some(()));
    search.running.signal("TERM");
    assert_eq!(search.finish().code, Some(143));
    assert!(nothing_left(&folder));
}

/// An episode that always ends the bench is repeated, and then says so.
#[test]
fn results_of_the_bench_are_repeated() {
    let folder = folder();
    folder.file("Grasp.lua", "TestCase = {}\nfunction TestCase.setup() error('no licence') end\n");
    let (mut search, _) = Search::start(&folder, &[]);
    let answer = search.ask(&json!({}));
    assert_eq!((&answer["outcome"], &answer["episode"]), (&json!("error"), &json!(1)), "{answer}");
    let episodes = folder.read("rtf-results/searches/latest/workers/1/latest/episodes.jsonl");
    assert_eq!(episodes.lines().filter(|line| line.contains("outcome")).count(), 3);
    for _ in 0..3 {
        search.write("{}");
    }
    assert_eq!([search.read()["ask"].clone(), search.read()["ask"].clone()], [json!(2), json!(3)]);
    let finished = search.finish();
    assert_eq!(finished.code, Some(3), "{}", finished.stderr);
    assert!(finished.stderr.contains("10 results in succession"), "{}", finished.stderr);
}

#[test]
fn a_stream_that_is_not_a_list_of_episodes() {
    let folder = folder();
    let run = |lines: &str| {
        let mut command = folder.command(&["run", "grasp.xml", "--episodes", "-"]);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("rtf starts");
        let mut input = child.stdin.take().expect("a pipe");
        input.write_all(lines.as_bytes()).expect("rtf reads");
        drop(input);
        Finished::of(child.wait_with_output().expect("it ends"))
    };
    let episode = |id: u64, name: &str| {
        let parameters = json!({name: "1", "surface": "ice"});
        format!("{}\n", json!({"id": id, "seed": 1, "parameters": parameters}))
    };
    let passed = run(&(episode(1, "payload") + &episode(2, "payload")));
    assert_eq!(passed.code, Some(0), "{}{}", passed.stdout, passed.stderr);
    assert_eq!(run("").code, Some(2));
    let damaged = run("rubbish\n");
    assert!(damaged.stderr.contains("line 1 of standard input is not an episode"));
    assert_eq!(damaged.code, Some(2));
    let other = run(&(episode(1, "payload") + &episode(2, "mass")));
    assert_eq!(other.code, Some(1), "{}{}", other.stdout, other.stderr);
    let expected =
        "line 2 of standard input is not an episode: its parameters are not payload, surface";
    assert!(other.stdout.contains(expected), "{}{}", other.stdout, other.stderr);
    assert!(nothing_left(&folder));
}
