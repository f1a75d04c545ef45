//! Campaigns are imported when they end, and `rtf history` shows their rates and where these
//! changed.

use insta::assert_snapshot;
use regex::Regex;
use serde_json::Value;

use crate::history::rtf;
use crate::support::{Folder, wait_until};

const CAMPAIGN: &str = "<campaign suite='grasp.xml' seed='4' episodes='EPISODES'>\n\
    <parameter name='payload' distribution='uniform' low='0' high='2'/>\n\
    <claim require='rate &gt;= 0.5' confidence='0.95'/></campaign>\n";

/// A repository with a campaign that passes if the payload is below the limit.
fn folder(episodes: u32) -> Folder {
    let folder = Folder::new();
    set_limit(&folder, "1.95", '0');
    folder.file("grasp.xml", "<suite name='grasp'><test>Grasp.lua</test></suite>");
    folder.file("campaign.xml", &CAMPAIGN.replace("EPISODES", &episodes.to_string()));
    folder.file(".git/HEAD", "ref: refs/heads/main\n");
    folder
}

/// Changes the tested code, and commits that.
fn set_limit(folder: &Folder, limit: &str, digit: char) {
    let test = format!(
        "TestCase = {{}}\nfunction TestCase.run()\n  \
         local payload = tonumber(os.getenv('RTF_PARAM_PAYLOAD'))\n  \
         rtf.check(payload < {limit}, 'too heavy')\nend\n"
    );
    folder.file("Grasp.lua", &test);
    folder.file(".git/refs/heads/main", &format!("{}\n", digit.to_string().repeat(40)));
}

fn run(folder: &Folder, more: &[&str]) -> Option<i32> {
    rtf(folder, &[&["campaign", "run", "campaign.xml"], more].concat()).code
}

fn json(folder: &Folder, args: &[&str]) -> Value {
    let finished = rtf(folder, &[&["history"], args, &["--format", "json"]].concat());
    assert_eq!(finished.code, Some(0), "{}", finished.stderr);
    serde_json::from_str(&finished.stdout).expect("JSON")
}

fn shown(folder: &Folder, args: &[&str]) -> String {
    let finished = rtf(folder, &[&["history"], args].concat());
    let text = folder.shown(&finished);
    let host = rustix::system::uname().nodename().to_string_lossy().into_owned();
    let text = text.replace(&format!(", {host}  "), ", [HOST]  ");
    let time = Regex::new(r"\d{4}-\d\d-\d\d \d\d:\d\d").expect("a pattern");
    time.replace_all(&text, "[START]").into_owned()
}

#[test]
fn rates_over_commits_and_the_commit_of_a_drop() {
    let folder = folder(40);
    for digit in ['1', '2', '3'] {
        set_limit(&folder, "1.95", digit);
        assert_eq!(run(&folder, &[]), Some(0));
    }
    set_limit(&folder, "0.9", '4');
    assert_eq!(run(&folder, &[]), Some(6));
    assert_snapshot!(shown(&folder, &["campaigns", "--last", "2"]), @"
    exit code 0
    ----- stdout
    [START]  undecided  campaign  37.5 % (22.7 to 54.2), claim rate >= 0.5  40 episodes  main, 44444444, [HOST]  [RUN]
    [START]  passed     campaign  97.5 % (86.8 to 99.9), claim rate >= 0.5  40 episodes  main, 33333333, [HOST]  [RUN]
    ----- stderr
    ");
    assert_snapshot!(shown(&folder, &["rates", "campaign"]), @"
    exit code 0
    ----- stdout
    campaign  (campaign.xml)
      ███▁
      [START]  11111111   97.5 % (87.1 to 99.6)     39 of 40 passed  passed
      [START]  22222222   97.5 % (87.1 to 99.6)     39 of 40 passed  passed
      [START]  33333333   97.5 % (87.1 to 99.6)     39 of 40 passed  passed
      [START]  44444444   37.5 % (24.2 to 53.0)     15 of 40 passed  undecided
    ----- stderr
    ");
    assert_snapshot!(shown(&folder, &["changes"]), @"
    exit code 0
    ----- stdout
    [START]  campaign campaign  rate  97.5 % (92.9 to 99.1) → 37.5 % (24.2 to 53.0)
      since [RUN], commits 33333333..44444444, p < 0.0001, episodes: 120 in 3 campaigns before, 40 in 1 campaign since
    ----- stderr
    ");
    let change = &json(&folder, &["changes"])["campaign_changes"][0];
    assert_eq!(change["commit"], "4".repeat(40));
    assert_eq!(change["commit_before"], "3".repeat(40));
    assert_eq!(
        json(&folder, &["changes", "-E", "name(Grasp)"])["campaign_changes"][0],
        Value::Null
    );
    assert_snapshot!(shown(&folder, &["changes", "--min-size", "90"]), @"
    exit code 0
    ----- stdout
    no changes
    ----- stderr
    ");
    assert_snapshot!(shown(&folder, &["rates", "other"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: the history has no campaign `other`
    hint: campaigns of the history: campaign
    ");
}

#[test]
fn other_parameters_are_another_series() {
    let folder = folder(40);
    assert_eq!(run(&folder, &[]), Some(0));
    // Harder parameters are another series.
    folder
        .file("campaign.xml", &CAMPAIGN.replace("EPISODES", "40").replace("low='0'", "low='1.9'"));
    assert_ne!(run(&folder, &[]), Some(0));
    assert_eq!(json(&folder, &["rates"])["rates"].as_array().map(Vec::len), Some(2));
    assert_eq!(json(&folder, &["changes"])["campaign_changes"], Value::Array(Vec::new()));
    let newest = json(&folder, &["campaigns", "--commit", "0000", "--last", "1"]);
    let newest = &newest["campaigns"][0];
    assert_eq!(
        (&newest["file"], &newest["suite_file"]),
        (&"campaign.xml".into(), &"grasp.xml".into())
    );
    assert_eq!((&newest["run"], &newest["rule"]), (&40.into(), &"fixed".into()));
    assert_eq!(json(&folder, &["campaigns", "--branch", "other"])["campaigns"][0], Value::Null);
}

#[test]
fn the_database_can_be_recreated_from_the_files() {
    let folder = folder(12);
    assert_eq!(run(&folder, &["--workers", "2"]), Some(0));
    folder.file(
        "grasp.xml",
        "<suite name='grasp'><fixture type='process' name='f'>\
        <command>false</command><ready log='x'/></fixture><test>Grasp.lua</test></suite>",
    );
    assert_eq!(run(&folder, &[]), Some(6), "the bench is broken");
    let export = |history: &[&str]| {
        let tables = ["campaigns", "episodes"].map(|table| {
            let args =
                [&["history", "export", "--format", "csv", "--table", table], history].concat();
            let finished = rtf(&folder, &args);
            assert_eq!(finished.code, Some(0), "{}", finished.stderr);
            finished.stdout
        });
        tables.concat()
    };
    let before = export(&[]);
    assert!(before.lines().count() > 14 && before.contains("bench-broken"), "{before}");
    let other = ["--history", "other.db"];
    let imported = rtf(&folder, &[&["history", "import"][..], &other].concat());
    assert_eq!(imported.stdout, "0 runs imported, 2 campaigns imported\n", "{}", imported.stderr);
    assert_eq!(export(&other), before);
    let again = rtf(&folder, &[&["history", "import", "rtf-results"][..], &other].concat());
    assert_eq!(again.stdout, "0 runs imported, 2 already there\n", "{}", again.stderr);
    // A campaign file that was removed or changed does not matter.
    folder.file("campaign.xml", "");
    let latest = ["history", "import", "rtf-results/campaigns/latest", "--history", "third.db"];
    assert_eq!(rtf(&folder, &latest).stdout, "0 runs imported, 1 campaign imported\n");
    assert_eq!(json(&folder, &["doctor"])["checks"]["campaigns"], 2);
    let parquet =
        ["history", "export", "--format", "parquet", "--table", "episodes", "-o", "e.parquet"];
    assert_eq!(rtf(&folder, &parquet).code, Some(0));
    assert!(folder.path().join("e.parquet").is_file());
}

#[test]
fn old_campaigns_are_pruned() {
    let folder = folder(8);
    for _ in 0..3 {
        assert!(run(&folder, &[]).is_some_and(|code| code != 1));
    }
    assert_snapshot!(shown(&folder, &["prune", "--keep", "1", "--dry-run"]), @"
    exit code 0
    ----- stdout
    [START]  undecided  campaign  87.5 % (47.3 to 99.7), claim rate >= 0.5  8 episodes  main, 00000000, [HOST]  [RUN]
    [START]  undecided  campaign  87.5 % (47.3 to 99.7), claim rate >= 0.5  8 episodes  main, 00000000, [HOST]  [RUN]
    0 runs and 2 campaigns would be removed
    ----- stderr
    ");
    let removed = json(&folder, &["prune", "--keep", "1"]);
    assert_eq!(removed["removed_campaigns"].as_array().map(Vec::len), Some(2));
    let checks = &json(&folder, &["doctor"])["checks"];
    assert_eq!((&checks["campaigns"], &checks["pruned_campaigns"]), (&1.into(), &2.into()));
    assert_eq!(checks["missing"], Value::Array(Vec::new()), "pruned ones are not missing");
    assert!(run(&folder, &[]).is_some());
    assert_eq!(json(&folder, &["campaigns"])["campaigns"].as_array().map(Vec::len), Some(2));
}

#[test]
fn a_history_that_cannot_be_written_is_one_warning() {
    let folder = folder(8);
    folder.file("rtf-results/history.db", "no database");
    let finished = rtf(&folder, &["campaign", "run", "campaign.xml"]);
    assert!(matches!(finished.code, Some(0 | 6)), "{}", finished.stderr);
    assert_eq!(finished.stderr.lines().count(), 1, "{}", finished.stderr);
    let warning = "warning: the campaign was not imported into the history: ";
    assert!(finished.stderr.starts_with(warning), "{}", finished.stderr);
    std::fs::remove_file(folder.path().join("rtf-results/history.db")).expect("removed");
    assert!(run(&folder, &["--no-history"]).is_some());
    assert!(!folder.path().join("rtf-results/history.db").exists());
    let doctor = rtf(&folder, &["history", "doctor"]);
    assert_eq!(doctor.code, Some(2), "there is no database");
    // The next campaign imports the earlier ones.
    assert!(run(&folder, &[]).is_some());
    assert_eq!(json(&folder, &["campaigns"])["campaigns"].as_array().map(Vec::len), Some(3));
}

#[test]
fn a_campaign_that_was_killed_is_imported_and_replaced_when_it_was_resumed() {
    let folder = folder(60);
    let test = "TestCase = {}\nfunction TestCase.run() rtf.sleep(0.05) end\n";
    folder.file("Grasp.lua", test);
    let mut running = folder.start(&["campaign", "run", "campaign.xml"]);
    let dir = "rtf-results/campaigns/latest";
    let results = folder.path().join(dir).join("workers/1/latest/episodes.jsonl");
    wait_until("some episodes", || {
        std::fs::read_to_string(&results).ok().filter(|text| text.lines().count() > 8)
    });
    let active = rtf(&folder, &["history", "import"]);
    assert!(active.stdout.contains("1 still active"), "{}", active.stdout);
    running.child.kill().expect("killed");
    running.child.wait().expect("ended");
    let imported = wait_until("the end of the worker", || {
        let imported = rtf(&folder, &["history", "import"]).stdout;
        (!imported.contains("active")).then_some(imported)
    });
    assert_eq!(imported, "0 runs imported, 1 campaign imported\n");
    let campaign = &json(&folder, &["campaigns"])["campaigns"][0];
    assert_eq!(campaign["end"], "unfinished");
    assert!(campaign["run"].as_u64().is_some_and(|run| run < 60), "{campaign}");
    assert_eq!(rtf(&folder, &["campaign", "run", "--resume", dir]).code, Some(0));
    let campaigns = json(&folder, &["campaigns"]);
    assert_eq!(campaigns["campaigns"].as_array().map(Vec::len), Some(1));
    let resumed = &campaigns["campaigns"][0];
    assert_eq!((&resumed["end"], &resumed["run"]), (&"finished".into(), &60.into()));
    assert_eq!(resumed["id"], campaign["id"]);
}

#[test]
fn a_page_of_a_campaign() {
    let folder = folder(8);
    assert!(run(&folder, &[]).is_some());
    let refused = rtf(&folder, &["campaign", "show", "--output", "x.html"]);
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    let bad = ["campaign", "show", "--format", "html", "--output", "."];
    assert_eq!(rtf(&folder, &bad).code, Some(2));
    let page = rtf(&folder, &["campaign", "show", "--format", "html", "--output", "x.html"]);
    // A build without the page refuses it.
    match page.code {
        Some(0) => assert!(folder.read("x.html").contains("id=\"rtf-overview\"")),
        code => assert_eq!(code, Some(2), "{}", page.stderr),
    }
}
