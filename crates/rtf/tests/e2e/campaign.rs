//! Campaigns: workers run episodes, and their results decide about the claim.

use insta::assert_snapshot;
use regex::Regex;
use rtf_report::episode_results::EpisodeLine;

use crate::support::{Finished, Folder, nothing_left};

/// Fails if the payload is 2 or more.
pub const GRASP: &str = "TestCase = {}\nfunction TestCase.run()\n  \
    local payload = tonumber(os.getenv('RTF_PARAM_PAYLOAD'))\n  \
    rtf.check(payload < 2, 'too heavy')\nend\n";
pub const SUITE: &str =
    "<suite name='grasp'><test param='${param:payload}'>Grasp.lua</test></suite>";
/// Four of five values pass.
const PAYLOAD: &str = "<parameter name='payload' distribution='uniform' low='0' high='2.5'/>";

pub fn folder(suite: &str, campaign: &str) -> Folder {
    let folder = Folder::new();
    folder.file("Grasp.lua", GRASP).file("grasp.xml", suite);
    folder.file("campaign.xml", &format!("<campaign suite='grasp.xml' {campaign}</campaign>"));
    folder
}

pub fn fixed(episodes: u32, rate: &str) -> String {
    let claim = format!("<claim require='rate &gt;= {rate}' confidence='0.95'/>");
    format!("episodes='{episodes}'>{PAYLOAD}{claim}")
}

pub fn run(folder: &Folder, more: &[&str]) -> Finished {
    folder.rtf(&[&["campaign", "run", "campaign.xml"], more].concat())
}

/// The final results without durations, in the order of the episodes.
pub fn results(folder: &Folder) -> Vec<EpisodeLine> {
    let text = folder.read("rtf-results/campaigns/latest/results.jsonl");
    let line = |line| {
        let line: EpisodeLine = serde_json::from_str(line).expect("a result");
        assert!(line.duration_us > 0, "{line:?}");
        EpisodeLine { duration_us: 0, ..line }
    };
    text.lines().map(line).collect()
}

/// The output without the times of the name of the directory.
pub fn shown(folder: &Folder, finished: &Finished) -> String {
    let name = Regex::new(r"campaigns/[0-9TZ-]+-[0-9a-f]+").expect("a pattern");
    name.replace_all(&folder.shown(finished), "campaigns/[NAME]").into_owned()
}

#[test]
fn a_claim_holds_or_not_or_needs_more_episodes() {
    for (rate, code, verdict) in
        [("0.5", 0, "passed"), ("0.95", 1, "failed"), ("0.8", 6, "undecided")]
    {
        let folder = folder(SUITE, &fixed(60, rate));
        let finished = run(&folder, &["--workers", "2"]);
        assert_eq!(finished.code, Some(code), "{}{}", finished.stdout, finished.stderr);
        let expected = format!("claim rate >= {rate}: {verdict}\n");
        assert!(finished.stdout.ends_with(&expected), "{}", finished.stdout);
        let forecast = finished.stdout.contains("  a decision needs ");
        assert_eq!(forecast, verdict == "undecided", "{}", finished.stdout);
        assert!(nothing_left(&folder));
    }
}

#[test]
fn what_is_printed() {
    let campaign = "seed='4' episodes='4'><parameter name='payload' distribution='choice' values='1 3'/>\
        <claim require='rate >= 0.9' confidence='0.9'/>";
    let folder = folder(SUITE, campaign);
    assert_snapshot!(shown(&folder, &run(&folder, &[])), @"
    exit code 6
    ----- stdout
    campaign campaign: 4 episodes, 1 worker, claim rate >= 0.9
      failed    episode 1  payload=3
                Grasp: too heavy
      failed    episode 2  payload=3
                Grasp: too heavy

    4 of 4 episodes
      passed            2
      failed            2
      rate 0.5000, between 0.0976 and 0.9024 (Clopper and Pearson, 90 % confidence)
      a decision needs about 2 more episodes at the present rate, 6 in all
    results: rtf-results/campaigns/[RUN]
    claim rate >= 0.9: undecided
    ----- stderr
    ");
}

#[test]
fn the_results_do_not_depend_on_the_number_of_workers() {
    let folder = folder(SUITE, &fixed(24, "0.5"));
    let mut all = Vec::new();
    for workers in ["1", "2", "4"] {
        assert_eq!(run(&folder, &["-w", workers]).code, Some(0));
        all.push(results(&folder));
    }
    assert_eq!(all[0].len(), 24);
    assert!(all[0] == all[1] && all[0] == all[2], "{all:?}");
}

#[test]
fn a_sequential_rule_ends_the_campaign_early() {
    let campaign = format!(
        "episodes='5000'>{PAYLOAD}<claim require='rate >= 0.5'/>\
         <stop rule='sprt' low='0.3' high='0.7' alpha='0.01' beta='0.01'/>"
    );
    let folder = folder(SUITE, &campaign);
    let finished = run(&folder, &["--workers", "2"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(finished.stdout.contains("  decided after "), "{}", finished.stdout);
    assert!(results(&folder).len() < 1000);
}

const SIMULATOR: &str = "<suite name='grasp'>\
    <fixture name='sim' type='process'>\
      <command>sh -c 'echo \"start $RTF_PARAM_PAYLOAD\" >> log; echo up; exec sleep 1000'</command>\
      <ready log='up'/>RESET\
    </fixture>\
    <test>Grasp.lua</test></suite>";
const GRID: &str = ">\
    <parameter name='payload' distribution='grid' values='0 1 2'/>\
    <claim require='rate >= 0.1' confidence='0.6'/>";

#[test]
fn a_fixture_is_restarted_or_reset_for_each_episode() {
    let restarted = folder(&SIMULATOR.replace("RESET", ""), GRID);
    run(&restarted, &[]);
    assert_eq!(restarted.read("log"), "start 0\nstart 1\nstart 2\n");
    let reset = "<reset command=\"sh -c 'echo reset $RTF_PARAM_PAYLOAD $RTF_EPISODE >> log'\"/>";
    let reset = folder(&SIMULATOR.replace("RESET", reset), GRID);
    run(&reset, &[]);
    assert_eq!(reset.read("log"), "start 0\nreset 1 2\nreset 2 3\n");
    assert_eq!(results(&restarted), results(&reset));
    assert!(nothing_left(&reset));
    let plugin =
        folder(&SIMULATOR.replace("RESET", "<reset param='start'>Reset.lua</reset>"), GRID);
    plugin.file(
        "Reset.lua",
        "TestCase = {}\nfunction TestCase.setup(arguments)\n  \
         local log = io.open('log', 'a')\n  \
         log:write('reset ', arguments, ' ', os.getenv('RTF_PARAM_PAYLOAD'), '\\n')\n  \
         log:close()\nend\nfunction TestCase.run() end\n",
    );
    run(&plugin, &[]);
    assert_eq!(plugin.read("log"), "start 0\nreset start 1\nreset start 2\n");
    assert_eq!(results(&restarted), results(&plugin));
}

#[test]
fn a_collapse_is_repeated_and_counted_apart() {
    // The simulator dies in its first life.
    let suite = "<suite name='grasp'><fixture name='sim' type='process' restarts='0'>\
        <command>sh -c 'if mkdir first; then sleep 0.3; exit 9; fi; exec sleep 1000'</command>\
        </fixture><test>Slow.lua</test></suite>";
    let folder = folder(suite, GRID);
    folder.file("Slow.lua", "TestCase = {}\nfunction TestCase.run() rtf.sleep(0.6) end\n");
    let finished = run(&folder, &[]);
    let outcomes: Vec<_> = results(&folder).iter().map(|line| line.outcome).collect();
    let passed = Some(rtf_model::EpisodeOutcome::Passed);
    assert_eq!(outcomes, [passed; 3], "{}", finished.stdout);
    let counted = "errors and collapses of the bench: 1";
    assert!(finished.stdout.contains(counted), "{}", finished.stdout);
}

#[test]
fn a_bench_that_does_not_work_ends_the_campaign() {
    let folder = folder(SUITE, &fixed(100, "0.5"));
    folder.file("Grasp.lua", "TestCase = {}\nfunction TestCase.run() rtf.error('no arm') end\n");
    let finished = run(&folder, &[]);
    assert_eq!(finished.code, Some(6), "{}", finished.stdout);
    assert!(finished.stdout.contains("  ended early: 10 executions"), "{}", finished.stdout);
    assert!(nothing_left(&folder));
}

#[test]
fn an_episode_is_repeated_from_the_file_or_the_results() {
    let folder = folder(SUITE, &fixed(12, "0.5"));
    run(&folder, &[]);
    let wanted = results(&folder);
    let failed = wanted.iter().find(|line| line.reason.is_some()).expect("a failure");
    let id = failed.episode.to_string();
    for input in ["campaign.xml", "rtf-results/campaigns/latest"] {
        let finished = folder.rtf(&["run", "--episode", &id, input]);
        assert_eq!(finished.code, Some(1), "{}", finished.stderr);
        assert!(finished.stdout.contains("too heavy"), "{}", finished.stdout);
        // The same as an ordinary run.
        assert_eq!(folder.rtf(&["run", "--rerun=failed"]).code, Some(1));
    }
    let unknown = folder.rtf(&["run", "--episode", "13", "campaign.xml"]);
    assert_eq!(unknown.code, Some(2));
    assert_snapshot!(unknown.stderr, @"
    error: `campaign.xml` has no episode 13
    hint: its episodes are 1 to 12
    ");
}

#[test]
fn an_episode_runs_again_with_the_settings_of_its_campaign() {
    let folder = folder(SUITE, &fixed(12, "0.5"));
    let test = "TestCase = {}\nfunction TestCase.run()\n  \
        rtf.check(os.getenv('RTF_PARAM_MODE') == 'good', 'bad mode')\nend\n";
    folder.file("Grasp.lua", test);
    assert_eq!(run(&folder, &["--set", "mode=bad"]).code, Some(1));
    let again = ["run", "--episode", "1", "rtf-results/campaigns/latest"];
    let finished = folder.rtf(&again);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    assert!(finished.stdout.contains("bad mode"), "{}", finished.stdout);
    let other = folder.rtf(&[&again[..], &["--set", "mode=good"]].concat());
    assert_eq!(other.code, Some(0), "{}{}", other.stdout, other.stderr);
}

#[test]
fn mistakes_are_reported_before_anything_starts() {
    let unknown = folder("<suite><test>Gone.lua</test></suite>", &fixed(5, "0.5"));
    for args in [["check", "campaign.xml"].as_slice(), &["campaign", "run", "campaign.xml"]] {
        let finished = unknown.rtf(args);
        assert_eq!(finished.code, Some(2), "{}", finished.stdout);
        assert!(finished.stderr.contains("`Gone.lua`"), "{}", finished.stderr);
    }
    assert!(!unknown.path().join("rtf-results").exists());
    let valid = folder(SUITE, &fixed(5, "0.5"));
    assert_snapshot!(valid.rtf(&["check", "campaign.xml"]).stdout, @"1 campaign, 5 episodes: no errors");
    assert_snapshot!(valid.rtf(&["run", "campaign.xml"]).stderr, @"
    error: `campaign.xml` is not a suite: its first element is `<campaign>`
     --> campaign.xml:1:1
      |
    1 | <campaign suite='grasp.xml' episodes='5'><parameter name='payload' distribution='uniform' low='0' high='2.5'/><claim require='rate &g...
      | ^^^^^^^^^ `<suite>` is expected here
      |
      = help: `rtf campaign run` runs all episodes of a campaign, `rtf run --episode ID` one of them

    1 error; nothing was started
    ");
    assert_snapshot!(valid.rtf(&["campaign", "run", "--resume", "."]).stderr, @"
    error: `.` is not a campaign's directory: No such file or directory (os error 2)
    hint: `rtf campaign run` prints the directory of its results
    ");
    let slurm = ["--executor", "slurm", "--shards", "2"];
    let kubernetes = ["--executor", "kubernetes", "--shards", "2"];
    for (options, error) in [
        (&["--shards", "2"][..], "`--shards` has no effect without `--executor slurm` or"),
        (&slurm[..2], "`--executor slurm` needs the number of shards"),
        (&[&slurm[..], &["-w2"]].concat(), "`--workers` has no effect with `--executor slurm`"),
        (&[&slurm[..], &["--resume", "."]].concat(), "cannot be used with"),
        (
            &[&slurm[..], &["--executor-print"]].concat(),
            "`--executor-print` has no effect without `--executor kubernetes`",
        ),
        (&kubernetes, "`--executor kubernetes` needs an image with `rtf` and the suites"),
        (
            &[&kubernetes[..], &["--executor-image", "i"]].concat(),
            "`--executor kubernetes` needs a shared volume for the results",
        ),
    ] {
        let finished = run(&valid, options);
        assert_eq!(finished.code, Some(2), "{options:?}");
        assert!(finished.stderr.contains(error), "{}", finished.stderr);
    }
    assert!(!valid.path().join("rtf-results").exists());
}

#[test]
fn the_results_show_where_a_campaign_fails() {
    let campaign = "><parameter name='payload' distribution='grid' values='1 3'/>\
        <parameter name='surface' distribution='grid' values='wood steel'/>\
        <claim require='rate >= 0.9' confidence='0.9'/>";
    let folder = folder(SUITE, campaign);
    run(&folder, &[]);
    let finished = folder.rtf(&["campaign", "show", "--map", "payload,surface"]);
    assert_snapshot!(shown(&folder, &finished), @"
    exit code 0
    ----- stdout

    4 of 4 episodes
      passed            2
      failed            2
      rate 0.5000, between 0.0976 and 0.9024 (Clopper and Pearson, 90 % confidence)
      a decision needs about 2 more episodes at the present rate, 6 in all
    results: rtf-results/campaigns/latest
    claim rate >= 0.9: undecided

    payload  (X² 4.0, p = 0.329)
      1  100.0 %   34.2 to 100.0      2 of 2     ████████████████████
      3    0.0 %    0.0 to  65.8      0 of 2

    surface  (X² 0.0, p = 1.000)
      steel   50.0 %    9.5 to  90.5      1 of 2     ██████████
      wood    50.0 %    9.5 to  90.5      1 of 2     ██████████

    surface by payload: percent passed
      wood   100.0    0.0
      steel  100.0    0.0
                 1      3
    ----- stderr
    ");
    let json = folder.rtf(&["campaign", "show", "--format", "json"]);
    let document: serde_json::Value = serde_json::from_str(&json.stdout).expect("JSON");
    assert_eq!(document["parameters"][0]["name"], "payload");
    let unknown = folder.rtf(&["campaign", "show", "--map", "payload,colour"]);
    assert_snapshot!(unknown.stderr, @"
    error: the campaign has no parameters `payload` and `colour`
    hint: its parameters are `payload`, `surface`
    ");
}

#[test]
fn workers_have_separate_networks() {
    let suite = "<suite name='grasp' isolate='network'>\
        <fixture name='sim' type='process'><command>python3 sim.py</command><ready tcp='127.0.0.1:17999'/>\
        <reset command='true'/></fixture>\
        <test>Grasp.lua</test></suite>";
    let folder = folder(suite, &fixed(8, "0.2"));
    // The port is always the same.
    folder.file(
        "sim.py",
        "import socket, time\ns = socket.create_server(('127.0.0.1', 17999))\n\
        while True:\n    s.accept()[0].close()\n",
    );
    let slow = GRASP.replace("  rtf.check", "  rtf.sleep(0.1)\n  rtf.check");
    folder.file("Grasp.lua", &slow);
    let finished = run(&folder, &["--workers", "3"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(!finished.stdout.contains("bench"), "{}", finished.stdout);
}
