//! Versions are compared, and episodes of a comparison planned.

use insta::assert_snapshot;

use crate::campaign::{SUITE, fixed, folder, run, shown};
use crate::support::Folder;

/// The results of a campaign in `grasp.xml`, in a directory.
fn version(folder: &Folder, limit: u32) -> String {
    let test = format!(
        "TestCase = {{}}\nfunction TestCase.run()\n  \
         local payload = tonumber(os.getenv('RTF_PARAM_PAYLOAD'))\n  \
         rtf.measure('sag', payload / {limit}, 'rad')\n  rtf.check(payload < {limit}, 'no')\nend\n"
    );
    folder.file("Grasp.lua", &test);
    run(folder, &[]);
    let newest = folder.path().join("rtf-results/campaigns/latest");
    newest.canonicalize().expect("results").to_string_lossy().into_owned()
}

#[test]
fn versions_are_compared_on_the_same_episodes() {
    let folder = folder(SUITE, &fixed(30, "0.5"));
    let (good, bad) = (version(&folder, 2), version(&folder, 1));
    let worse = folder.rtf(&["campaign", "compare", &good, &bad]);
    assert_eq!(worse.code, Some(1), "{}{}", worse.stdout, worse.stderr);
    assert_snapshot!(shown(&folder, &worse), @"
    exit code 1
    ----- stdout
    1     27 of 30 passed   90.0 %   74.4 to  96.5  [FOLDER]/rtf-results/campaigns/[RUN]
    2     17 of 30 passed   56.7 %   39.2 to  72.6  [FOLDER]/rtf-results/campaigns/[RUN]

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
    ----- stderr
    ");
    assert_eq!(folder.rtf(&["campaign", "compare", &bad, &good]).code, Some(0), "it is better");
    assert_eq!(folder.rtf(&["campaign", "compare", &good, &good]).code, Some(0));
    folder.file(
        "campaign.xml",
        "<campaign suite='grasp.xml' episodes='3'>\
        <parameter name='payload' distribution='uniform' low='0' high='1'/>\
        <claim require='rate >= 0.5' confidence='0.6'/></campaign>",
    );
    let other = version(&folder, 2);
    let refused = folder.rtf(&["campaign", "compare", &good, &other]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("have different episodes"), "{}", refused.stderr);
}

#[test]
fn several_versions_are_compared_by_condition() {
    let campaign = "episodes='20'><parameter name='payload' distribution='choice' values='0.5 1.5'/>\
        <claim require='rate >= 0.5' confidence='0.95'/>";
    let folder = folder(SUITE, campaign);
    let (good, bad) = (version(&folder, 2), version(&folder, 1));
    let by = ["campaign", "compare", &good, &bad, &good, "--by", "payload"];
    assert_snapshot!(shown(&folder, &folder.rtf(&by)), @"
    exit code 1
    ----- stdout
    1     20 of 20 passed  100.0 %   83.9 to 100.0  [FOLDER]/rtf-results/campaigns/[RUN]
    2     13 of 20 passed   65.0 %   43.3 to  81.9  [FOLDER]/rtf-results/campaigns/[RUN]
    3     20 of 20 passed  100.0 %   83.9 to 100.0  [FOLDER]/rtf-results/campaigns/[RUN]

    2 against 1: the same episodes, in pairs
      20 episodes with a result in both
        passed in both  13
        only in 1       7
        only in 2       0
        in neither      0
      difference -35.0 % (-56.7 to -11.7)
      p = 0.0156, adjusted p = 0.0312 (McNemar, Holm for 2 claims)
      2 is worse than 1 (p <= 0.05)

    3 against 1: the same episodes, in pairs
      20 episodes with a result in both
        passed in both  20
        only in 1       0
        only in 3       0
        in neither      0
      difference +0.0 % (-16.1 to +16.1)
      p = 1.0000, adjusted p = 1.0000 (McNemar, Holm for 2 claims)
      undecided: `rtf campaign plan` prints how many episodes a difference needs

    measurements, means of 1 and 2 (exploratory, p adjusted for 2)
      Grasp sag  0.425000 → 0.850000 rad  +0.425000 (0.310486 to 0.539514) rad  p = 0.0001, adjusted p = 0.0002  (20 values)

    measurements, means of 1 and 3 (exploratory, p adjusted for 2)
      Grasp sag  0.425000 → 0.425000 rad  +0.000000 (0.000000 to 0.000000) rad  p = 1.0000, adjusted p = 1.0000  (20 values)

    by payload (exploratory, p adjusted for 4)
      0.5
        1     13 of 13 passed  100.0 %   77.2 to 100.0
        2     13 of 13 passed  100.0 %   77.2 to 100.0  difference +0.0 % (-22.8 to +22.8)  p = 1.0000, adjusted p = 1.0000
        3     13 of 13 passed  100.0 %   77.2 to 100.0  difference +0.0 % (-22.8 to +22.8)  p = 1.0000, adjusted p = 1.0000
      1.5
        1      7 of 7 passed  100.0 %   64.6 to 100.0
        2      0 of 7 passed    0.0 %    0.0 to  35.4  difference -100.0 % (-100.0 to -49.9)  p = 0.0156, adjusted p = 0.0625
        3      7 of 7 passed  100.0 %   64.6 to 100.0  difference +0.0 % (-35.4 to +35.4)  p = 1.0000, adjusted p = 1.0000
    ----- stderr
    ");
    let json = folder.rtf(&[&by[..], &["--format", "json"]].concat());
    let document: serde_json::Value = serde_json::from_str(&json.stdout).expect("JSON");
    assert_eq!(document["versions"][1]["path"], bad);
    assert_eq!(document["comparisons"][0]["finding"], "worse");
    assert_eq!(document["comparisons"][0]["results"]["pairs"]["only_first"], 7);
    assert_eq!(document["by"]["conditions"][0]["comparisons"][1]["version"], 3);
}

#[test]
fn a_sequential_rule_is_noted() {
    let campaign = fixed(200, "0.5") + "<stop rule='confidence-sequence'/>";
    let folder = folder(SUITE, &campaign);
    let dir = version(&folder, 2);
    let compared = folder.rtf(&["campaign", "compare", &dir, &dir]);
    let note = "\nnote: the results of 2 have decided how many episodes ran: p is not exact\n";
    assert!(compared.stdout.contains(note), "{}", compared.stdout);
    assert_eq!(compared.code, Some(0));
}

/// The results of a campaign as a CSV file.
fn csv(folder: &Folder, dir: &str) -> String {
    let list = std::fs::read_to_string(format!("{dir}/episodes.jsonl")).expect("a list");
    let results = std::fs::read_to_string(format!("{dir}/results.jsonl")).expect("results");
    let json = |line: &str| -> serde_json::Value { serde_json::from_str(line).expect("JSON") };
    let rows = list.lines().map(json).zip(results.lines().map(json));
    let row = |(episode, result): (serde_json::Value, serde_json::Value)| {
        let outcome = result["outcome"].as_str().expect("an outcome").to_owned();
        format!("{},{},{outcome}\n", episode["id"], episode["seed"])
    };
    let text = format!("episode,seed,outcome\n{}", rows.map(row).collect::<String>());
    folder.file("version.csv", &text);
    text
}

#[test]
fn results_of_other_programs_are_versions() {
    let folder = folder(SUITE, &fixed(30, "0.5"));
    let (good, bad) = (version(&folder, 2), version(&folder, 1));
    // The same ids and seeds.
    let text = csv(&folder, &bad);
    let paired = folder.rtf(&["campaign", "compare", &good, "version.csv", "--by", "payload"]);
    assert_eq!(paired.code, Some(1), "{}{}", paired.stdout, paired.stderr);
    assert!(
        paired.stdout.contains("2 against 1: the same episodes, in pairs"),
        "{}",
        paired.stdout
    );
    folder.file("other.csv", &text.replacen("\n1,", "\n31,", 1));
    let tasks = "{\"per_task\": [{\"task_group\": \"reach\", \"task_id\": 3, \"metrics\": {\
        \"successes\": [true, true, false], \"sum_rewards\": [1.0, 2.0, 0.5]}}]}";
    std::fs::create_dir(folder.path().join("eval")).expect("a directory");
    folder.file("eval/eval_info.json", tasks);
    let compared = folder.rtf(&["campaign", "compare", "version.csv", "other.csv", "eval"]);
    assert_snapshot!(shown(&folder, &compared), @"
    exit code 0
    ----- stdout
    1     17 of 30 passed   56.7 %   39.2 to  72.6  version.csv
    2     17 of 30 passed   56.7 %   39.2 to  72.6  other.csv
    3      2 of 3 passed   66.7 %   20.8 to  93.9  eval

    2 against 1: independent, not in pairs: the ids or seeds of episodes differ
      difference +0.0 % (-23.7 to +23.7)
      p = 1.0000, adjusted p = 1.0000 (Fisher, Holm for 2 claims)
      undecided: `rtf campaign plan` prints how many episodes a difference needs

    3 against 1: independent, not in pairs: an episode has no seed
      difference +10.0 % (-38.6 to +42.3)
      p = 1.0000, adjusted p = 1.0000 (Fisher, Holm for 2 claims)
      undecided: `rtf campaign plan` prints how many episodes a difference needs
    ----- stderr
    ");
}

#[test]
fn files_without_results_are_refused() {
    let folder = folder(SUITE, &fixed(30, "0.5"));
    folder.file("version.csv", "episode,outcome\n1,passed\n2,failed\n");
    folder.file("eval.json", "{\"per_episode\": [{\"episode_ix\": 0, \"success\": true}]}");
    for (file, content) in [
        ("bad.csv", "episode,outcome\n1,passed\n2,ok\n"),
        ("bad.json", "{\n  \"per_episode\": [{\"episode_ix\": 0}]\n}\n"),
        ("bad.txt", ""),
    ] {
        folder.file(file, content);
    }
    let refused = |more: &[&str]| {
        let finished = folder.rtf(&[&["campaign", "compare", "version.csv"], more].concat());
        assert_eq!(finished.code, Some(2), "{more:?}");
        finished.stderr
    };
    assert_snapshot!(refused(&["bad.csv"]), @"
    error: bad.csv:3: `ok` in the column `outcome`, expected passed, failed, error, collapsed, or nothing
    hint: the header has `episode`, `outcome` or `success`, and optionally `seed`: episode,seed,outcome
    ");
    assert_snapshot!(refused(&["bad.json"]), @"
    error: bad.json:2: not the results of LeRobot: missing field `success` at line 2 column 35
    hint: `lerobot-eval` writes `eval_info.json`; other results can be a CSV file
    ");
    assert_snapshot!(refused(&["bad.txt"]), @"
    error: `bad.txt` has no results
    hint: the directory of a campaign, a `.csv` file, or LeRobot's `eval_info.json` is expected
    ");
    assert_snapshot!(refused(&["eval.json", "--by", "task"]), @"
    error: `version.csv` has no parameter `task`
    hint: it has no parameters
    ");
    assert!(refused(&[]).contains("has nothing to be compared with"));
}

#[test]
fn episodes_of_a_comparison_are_planned() {
    let folder = folder(SUITE, &fixed(30, "0.5"));
    let plan = |more: &[&str]| folder.rtf(&[&["campaign", "plan"], more].concat());
    let found = plan(&["--detect", "5%", "--rate", "0.9"]);
    assert_snapshot!(shown(&folder, &found), @"
    exit code 0
    ----- stdout
    rate 90 %
    episodes of each of 2 versions, to find a difference of 5 % with a probability of 80 %, alpha 0.05:
           157 (80.2 %)  in pairs, if the better version passes all that the worse one passes
           722 (80.0 %)  in pairs, if the results of an episode are independent
           721 (80.0 %)  different episodes, not in pairs
    ----- stderr
    ");
    let page = include_str!("../../../../docs/how-to/campaigns.md");
    assert!(page.contains(&format!("```text\n{}```", found.stdout)), "{}", found.stdout);
    let earlier = version(&folder, 2);
    let more = [&*earlier, "--detect", "20%", "--discordant", "30%", "--versions", "3"];
    assert_snapshot!(shown(&folder, &plan(&more)), @"
    exit code 0
    ----- stdout
    rate 90 % (27 of 30 episodes)
    episodes of each of 3 versions, to find a difference of 20 % with a probability of 80 %, alpha 0.05:
            73 (80.6 %)  in pairs, if only one version passes 30 % of the episodes
            81 (80.4 %)  different episodes, not in pairs
    rate 74.4 % (of the 95 % interval 74.4 to 96.5 %, the rate nearest to 50 %)
    episodes of each of 3 versions, to find a difference of 20 % with a probability of 80 %, alpha 0.05:
            73 (80.6 %)  in pairs, if only one version passes 30 % of the episodes
           117 (80.2 %)  different episodes, not in pairs
    ----- stderr
    ");
    let json = plan(&["--detect", "10%", "--rate", "90%", "--format", "json"]);
    let document: serde_json::Value = serde_json::from_str(&json.stdout).expect("JSON");
    assert_eq!(document[0]["numbers"][2]["assumption"], "independent-episodes");
    assert_eq!(document[0]["numbers"][2]["episodes"], 214);
    for (options, error) in [
        (&["--detect", "5", "--rate", "0.9"][..], "a number of percent above 0 and up to 100"),
        (&["--detect", "5%", "--rate", "1.5"], "a number from 0 to 1 is expected, or percent"),
        (&["--detect", "5%"], "required arguments were not provided"),
        (&["--detect", "60%", "--rate", "50%"], "no rate is 60 % above or below 50 %"),
        (
            &["--detect", "5%", "--rate", "0.9", "--discordant", "1%"],
            "only one version passes between 5 % and 25 % of the episodes",
        ),
    ] {
        let finished = plan(options);
        assert_eq!(finished.code, Some(2), "{options:?}");
        assert!(finished.stderr.contains(error), "{}", finished.stderr);
    }
}
