//! Trials of versions: blocks, the comparison, and what a blinded campaign shows.

use insta::assert_snapshot;
use serde_json::Value;

use crate::campaign::{SUITE, folder, run, shown};
use crate::support::{Finished, Folder, nothing_left};
use crate::web::Web;
use crate::web_client::get;

/// The strong version holds what the weak one drops.
const HOLD: &str = "TestCase = {}\nfunction TestCase.run()\n  \
    local payload = tonumber(os.getenv('RTF_PARAM_PAYLOAD'))\n  \
    local limit = os.getenv('RTF_PARAM_POLICY') == 'weak' and 1 or 2\n  \
    rtf.measure('sag', payload / limit, 'rad')\n  rtf.check(payload < limit, 'no')\nend\n";
const PAYLOAD: &str = "<parameter name='payload' distribution='uniform' low='0' high='2.5'/>";

fn trials(attributes: &str, versions: &str, test: &str) -> Folder {
    let versions = format!("<versions parameter='policy' {versions}/>");
    let folder = folder(SUITE, &format!("{attributes}>{PAYLOAD}{versions}"));
    folder.file("Grasp.lua", test);
    folder
}

fn json(finished: &Finished) -> Value {
    serde_json::from_str(&finished.stdout).expect("a document")
}

const LATEST: &str = "rtf-results/campaigns/latest";

#[test]
fn versions_are_tried_in_blocks_and_compared() {
    let folder = trials("episodes='30'", "values='strong weak'", HOLD);
    let finished = run(&folder, &[]);
    let text = shown(&folder, &finished);
    let (_, end) = text.split_once("60 of 60 trials").expect("all trials");
    assert_snapshot!(end, @"
      passed            44
      failed            16
    results: rtf-results/campaigns/[RUN]

    1     27 of 30 passed   90.0 %   74.4 to  96.5  strong
    2     17 of 30 passed   56.7 %   39.2 to  72.6  weak

    2 against 1: the same episodes, in pairs
      30 episodes with a result in both
        passed in both  17
        only in 1       10
        only in 2       0
        in neither      3
      difference -33.3 % (-50.3 to -14.2)
      p = 0.0020 (McNemar)
      2 is worse than 1 (p <= 0.05)

    measurements, means of 1 and 2 (exploratory)
      Grasp sag  0.477595 → 0.955191 rad  +0.477595 (0.351967 to 0.603223) rad  p = 0.0001  (30 values)

    versions: failed, a version is worse than 1
    ----- stderr
    ");
    assert_eq!(finished.code, Some(1));
    assert!(text.contains("  failed    trial 2 of 60, block 1  payload="), "{text}");
    assert!(text.contains("campaign campaign: 60 trials, 1 worker, 2 versions\n"), "{text}");
    assert_eq!(folder.rtf(&["campaign", "show"]).code, Some(0));
    let by = folder.rtf(&["campaign", "compare", LATEST, "--by", "payload"]);
    assert!(by.code == Some(1) && by.stdout.contains("\nby payload (exploratory"), "{}", by.stdout);
    assert!(nothing_left(&folder));
}

#[test]
fn the_comparison_is_that_of_separate_campaigns() {
    let together = trials("episodes='20' seed='3'", "values='strong weak weaker'", HOLD);
    run(&together, &["--workers", "2"]);
    let together = json(&together.rtf(&["campaign", "compare", LATEST, "--format", "json"]));
    // The same conditions, without versions.
    let claim = "<claim require='rate >= 0.5' confidence='0.9'/>";
    let apart = folder(SUITE, &format!("episodes='20' seed='3'>{PAYLOAD}{claim}"));
    let mut paths = Vec::new();
    for version in ["strong", "weak", "weaker"] {
        let version = format!("'{version}'");
        apart.file("Grasp.lua", &HOLD.replace("os.getenv('RTF_PARAM_POLICY')", &version));
        run(&apart, &[]);
        let newest = apart.path().join(LATEST).canonicalize().expect("results");
        paths.push(newest.to_string_lossy().into_owned());
    }
    let paths: Vec<_> = paths.iter().map(String::as_str).collect();
    let apart =
        json(&apart.rtf(&[&["campaign", "compare"], &paths[..], &["--format", "json"]].concat()));
    assert_eq!(together["comparisons"], apart["comparisons"]);
    assert_eq!(together["comparisons"].as_array().map(Vec::len), Some(2));
    let rates = |document: &Value| {
        let versions = document["versions"].as_array().expect("versions");
        versions.iter().map(|it| (it["passed"].clone(), it["rate"].clone())).collect::<Vec<_>>()
    };
    assert_eq!(rates(&together), rates(&apart));
    let names: Vec<_> =
        (0..3).map(|index| together["versions"][index]["version"].clone()).collect();
    assert_eq!(names, ["strong", "weak", "weaker"]);
}

/// From trial 5 on, the bench does not work: the campaign ends early. Everything names the version.
const TALKATIVE: &str = "TestCase = {}\nfunction TestCase.run()\n  \
    local policy = os.getenv('RTF_PARAM_POLICY')\n  print('loads ' .. policy)\n  \
    io.stderr:write('not policy-weak, not policy-', 'strong\\n')\n  \
    rtf.measure('sag of ' .. policy, 1, 'rad')\n  rtf.report('runs ' .. policy)\n  \
    if tonumber(os.getenv('RTF_EPISODE')) >= 5 and not os.getenv('BENCH_WORKS') then\n    \
    rtf.error('no ' .. policy .. ' today') end\n  \
    rtf.check(policy == 'policy-strong', policy .. ' dropped it')\nend\n";

/// The texts that would betray a version.
fn betrays(text: &str) -> bool {
    ["policy-weak", "policy-strong", "strong"].iter().any(|version| text.contains(version))
}

/// The report of the campaign, from a server.
fn served(folder: &Folder) -> Value {
    let server = Web::start(folder, &["serve", "--web", "127.0.0.1:0"]);
    let report = get(server.address, "/api/v1/campaigns/latest").json();
    server.end("TERM");
    report
}

fn blinded() -> Folder {
    let versions = "values='policy-weak policy-strong' blinded='true'";
    trials("episodes='4' repeats='20'", versions, TALKATIVE)
}

#[test]
fn nothing_that_is_shown_betrays_a_version() {
    let folder = blinded();
    let finished = run(&folder, &[]);
    assert_eq!(finished.code, Some(6), "{}{}", finished.stdout, finished.stderr);
    let shows_trial = finished.stdout.contains("trial 5 of 8, block 3  payload=");
    assert!(shows_trial && finished.stdout.contains("no *** today"), "{}", finished.stdout);
    let run_dir = format!("{LATEST}/workers/1/latest");
    for command in [
        &["campaign", "show"][..],
        &["campaign", "show", "--format", "json"],
        &["campaign", "compare", LATEST],
        &["show", "--verbose", &run_dir],
        &["report", &run_dir, "--format", "junit"],
        &["run", "--episode", "5", LATEST, "--verbose"],
    ] {
        let shown = folder.rtf(command);
        assert!(!shown.stdout.is_empty() || shown.code == Some(2), "{command:?}");
        assert!(
            !betrays(&shown.stdout) && !betrays(&shown.stderr),
            "{command:?} betrays a version"
        );
    }
    assert!(!betrays(&finished.stdout) && !betrays(&finished.stderr), "{}", finished.stdout);
    let report = served(&folder);
    assert!(!betrays(&report.to_string()), "{report}");
    assert_eq!((&report["versions"]["hidden"], &report["planned"]), (&true.into(), &8.into()));
    // Also what the server reads; and the run with one episode.
    for dir in [&run_dir, "rtf-results/latest"] {
        assert!(!betrays(&folder.read(&format!("{dir}/events.jsonl"))), "{dir}");
    }
    assert!(!betrays(&folder.read(&format!("{LATEST}/results.jsonl"))));
    let refused = folder.rtf(&["campaign", "compare", LATEST]);
    assert_eq!(refused.code, Some(2));
    assert_snapshot!(refused.stderr, @"
    error: the versions in rtf-results/campaigns/latest are hidden until all trials have results: 4 of 8
    hint: `rtf campaign show --unblind rtf-results/campaigns/latest` shows them earlier, and records that
    ");
}

#[test]
fn an_early_look_at_the_versions_is_recorded() {
    let folder = blinded();
    run(&folder, &[]);
    let shown = folder.rtf(&["campaign", "show", "--unblind"]);
    assert!(shown.stdout.contains("\npolicy  (X²"), "{}{}", shown.stdout, shown.stderr);
    let note = " unblinded it early, after 4 of 8 trials, at 2";
    assert!(shown.stdout.contains(note), "{}", shown.stdout);
    let verdict = "\nversions: undecided, not all trials have results in pairs\n";
    assert!(shown.stdout.contains(verdict), "{}", shown.stdout);
    let recorded: Value =
        serde_json::from_str(&folder.read(&format!("{LATEST}/unblinded.json"))).expect("JSON");
    assert_eq!((&recorded["trials"], &recorded["of"]), (&4.into(), &8.into()));
    // The first time counts, also after all trials.
    folder.rtf(&["campaign", "show", "--unblind"]);
    let mut resume = folder.command(&["campaign", "run", "--resume", LATEST]);
    let resumed = Finished::of(resume.env("BENCH_WORKS", "1").output().expect("rtf runs"));
    assert_eq!(resumed.code, Some(0), "{}{}", resumed.stdout, resumed.stderr);
    assert!(resumed.stdout.contains(note), "{}", resumed.stdout);
    let compared = folder.rtf(&["campaign", "compare", LATEST, "--format", "json"]);
    assert_eq!(json(&compared)["unblinded"]["trials"], 4);
}

#[test]
fn versions_are_shown_when_all_trials_have_results() {
    let folder = blinded();
    let mut command = folder.command(&["campaign", "run", "campaign.xml"]);
    let finished = Finished::of(command.env("BENCH_WORKS", "1").output().expect("rtf runs"));
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let (trials, end) = finished.stdout.split_once("8 of 8 trials").expect("all trials");
    assert!(!betrays(trials) && betrays(end), "{}", finished.stdout);
    let shown = folder.rtf(&["campaign", "show"]);
    assert!(betrays(&shown.stdout) && !shown.stdout.contains("unblinded"), "{}", shown.stdout);
    assert!(!folder.path().join(LATEST).join("unblinded.json").exists());
    let report = served(&folder);
    assert_eq!(report["versions"]["rates"][1]["version"], "policy-strong");
    let finding = "policy-strong and policy-weak: undecided (p = 0.1250)";
    assert_eq!(report["versions"]["findings"][0], finding);
    let again = folder.rtf(&["run", "--episode", "1", LATEST, "--verbose"]);
    assert!(betrays(&again.stdout), "{}", again.stdout);
}

#[test]
fn what_does_not_take_versions_says_so() {
    let folder = trials("episodes='2'", "values='strong weak'", HOLD);
    run(&folder, &[]);
    folder.file("trials.csv", "episode,outcome\n1,passed\n");
    for command in [
        &["campaign", "compare", LATEST, LATEST][..],
        &["campaign", "compare", "trials.csv"],
        &["campaign", "plan", LATEST, "--detect", "5%"],
        &["campaign", "shrink", "1", LATEST],
        &["campaign", "search", "campaign.xml"],
    ] {
        let refused = folder.rtf(command);
        assert_eq!(refused.code, Some(2), "{command:?}{}{}", refused.stdout, refused.stderr);
        assert!(refused.stderr.contains("hint: "), "{}", refused.stderr);
    }
    assert_snapshot!(shown(&folder, &folder.rtf(&["campaign", "compare", LATEST, LATEST])), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: `rtf-results/campaigns/latest` has the results of several versions
    hint: compare them by `rtf campaign compare` with it alone
    ");
    let history = folder.rtf(&["history", "campaigns"]);
    assert!(!history.stdout.contains("campaign.xml"), "{}", history.stdout);
}
