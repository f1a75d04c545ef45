//! Episode tests in C++: campaigns whose episodes are cases of one process.

use rtf_model::EpisodeOutcome::{self, Error, Failed, Passed};

use crate::campaign::{results, run};
use crate::support::{Finished, Folder, build_cpp, nothing_left, root};

/// A campaign of the plug-in, whose episodes have these payloads.
fn campaign(values: &str, param: &str, slots: u32) -> Folder {
    let plugins = build_cpp(&root().join("crates/rtf/tests/e2e/cpp"), "e2e-cpp");
    let plugin = plugins.join("Slots.so").display().to_string();
    let folder = Folder::new();
    let limits = "max-steps='4' max-time='3s'";
    let test = format!("<test slots='{slots}' {limits} param='{param}'>{plugin}</test>");
    folder.file("grasp.xml", &format!("<suite name='grasp'>{test}</suite>"));
    let parameter = format!("<parameter name='payload' distribution='grid' values='{values}'/>");
    let claim = "<claim require='rate &gt;= 0.1' confidence='0.6'/>";
    folder.file(
        "campaign.xml",
        &format!("<campaign suite='grasp.xml'>{parameter}{claim}</campaign>"),
    );
    folder
}

/// The processes and the episodes that they finished, in this order.
fn log(folder: &Folder) -> Vec<(String, u64)> {
    let line = |line: &str| {
        let (process, episode) = line.split_once(' ').expect("two words");
        (process.to_owned(), episode.parse().expect("a number"))
    };
    folder.read("log").lines().map(line).collect()
}

/// The results in the order of the episodes. Reasons are without the name of the test.
fn outcomes(folder: &Folder) -> Vec<(Option<EpisodeOutcome>, String)> {
    let mut lines = results(folder);
    lines.sort_by_key(|line| line.episode);
    let reason = |reason: String| reason.strip_prefix("Slots: ").unwrap_or(&reason).to_owned();
    lines
        .into_iter()
        .map(|line| (line.outcome, line.reason.map(reason).unwrap_or_default()))
        .collect()
}

fn with_reason(outcome: EpisodeOutcome, reason: &str) -> (Option<EpisodeOutcome>, String) {
    (Some(outcome), reason.to_owned())
}

fn output(finished: &Finished) -> String {
    format!("{}{}", finished.stdout, finished.stderr)
}

#[test]
fn each_episode_has_its_result_and_the_others_continue() {
    let folder = campaign("10 1 4 3 5 6 11", "", 3);
    let finished = run(&folder, &[]);
    let expected = [
        with_reason(Passed, ""),
        with_reason(Failed, "too heavy"),
        with_reason(Failed, "dropped"),
        with_reason(Failed, "case `4/grasp`: slipped"),
        with_reason(Error, "no gripper"),
        with_reason(Failed, "not done after 4 steps"),
        with_reason(Passed, ""),
    ];
    assert_eq!(outcomes(&folder), expected, "{}", output(&finished));
    let log = log(&folder);
    assert!(log[..7].iter().all(|(process, _)| *process == log[0].0), "{log:?}");
    // One without a result is repeated.
    let mut order: Vec<u64> = log.iter().map(|(_, episode)| *episode).collect();
    assert_eq!(order[0], 3, "{order:?}");
    order.sort_unstable();
    assert_eq!(order, [1, 2, 3, 4, 5, 5, 5, 6, 7]);
    assert_eq!(finished.code, Some(0), "{}", output(&finished));
    assert!(nothing_left(&folder));
}

#[test]
fn measurements_belong_to_the_episode() {
    let folder = campaign("10 6 11", "", 3);
    run(&folder, &[]);
    let mut lines = results(&folder);
    lines.sort_by_key(|line| line.episode);
    for (line, steps) in lines.iter().zip([1.0, 4.0, 1.0]) {
        let mut values: Vec<_> = line
            .measurements
            .iter()
            .map(|it| (it.name.as_str(), it.unit.as_str(), it.value.expect("a number")))
            .collect();
        values.sort_by_key(|value| value.0);
        let distance = f64::from(u32::try_from(line.episode).expect("a small number"));
        let expected = [
            ("distance", "m", distance),
            ("simulated time", "s", steps / 2.0),
            ("steps", "", steps),
        ];
        assert_eq!(values, expected, "{line:?}");
        assert_eq!(line.first_observation.as_ref().map(String::len), Some(16));
    }
    assert!(lines[0].first_observation != lines[1].first_observation, "{lines:?}");
}

/// An exception is an error of its episode, which runs again alone; the others have their results.
#[test]
fn an_exception_in_an_episode_is_an_error_of_it() {
    let folder = campaign("10 2 1 11", "", 4);
    let finished = run(&folder, &[]);
    let expected = [
        with_reason(Passed, ""),
        with_reason(Error, "std::runtime_error: no simulator"),
        with_reason(Failed, "too heavy"),
        with_reason(Passed, ""),
    ];
    assert_eq!(outcomes(&folder), expected, "{}", output(&finished));
    let episodes: Vec<u64> = log(&folder).iter().map(|(_, episode)| *episode).collect();
    assert_eq!(episodes, [4, 3, 2, 1, 2, 2], "{}", output(&finished));
    assert!(nothing_left(&folder));
}

/// It is unknown which of the open episodes crashed: each of them runs again alone.
#[test]
fn episodes_that_were_open_in_a_crash_run_again_alone() {
    let folder = campaign("10 9 11 1", "", 4);
    let finished = run(&folder, &[]);
    let found = outcomes(&folder);
    assert_eq!(found[0], with_reason(Passed, ""), "{}", output(&finished));
    assert!(found[1].0 == Some(Failed) && found[1].1.contains("SIGABRT"), "{found:?}");
    assert_eq!(found[2..], [with_reason(Passed, ""), with_reason(Failed, "too heavy")]);
    let log = log(&folder);
    let of = |episode: u64| log.iter().filter(|line| line.1 == episode).count();
    assert_eq!([of(4), of(3), of(2), of(1)], [1, 1, 2, 1], "{log:?}");
    assert!(finished.stdout.contains("and repeated: 2"), "{}", output(&finished));
    assert!(nothing_left(&folder));
}

#[test]
fn finishing_twice_and_returning_early_are_errors() {
    for (param, reason) in [
        ("twice", "episode 1 is not open: it has finished already, or the test has not taken it"),
        ("early", "`run` returned before the last episode: take episodes until none follows"),
    ] {
        let folder = campaign("10 11 12 13", param, 1);
        let finished = run(&folder, &[]);
        assert!(output(&finished).contains(reason), "{param}: {}", output(&finished));
        assert_ne!(finished.code, Some(0), "{param}");
        assert!(nothing_left(&folder));
    }
}

/// Without a campaign, there is one episode.
#[test]
fn a_run_has_one_episode() {
    let folder = campaign("10", "", 4);
    let finished = folder.rtf(&["run", "grasp.xml"]);
    assert_eq!(finished.code, Some(0), "{}", output(&finished));
    assert_eq!(log(&folder).len(), 1);
    let finished = folder.rtf(&["run", "grasp.xml", "--set", "payload=1"]);
    assert_eq!(finished.code, Some(1), "{}", output(&finished));
}
