//! Campaigns whose test is one in Python with slots: one process for all episodes of a worker.

use rtf_model::EpisodeOutcome::{self, Error, Failed, Passed};
use rtf_report::episode_results::EpisodeLine;

use crate::campaign::{results, run};
use crate::support::{Finished, Folder, nothing_left};

/// Its episodes take as many steps as the payload says, and reports what the tests look at.
const WALK: &str = "import os\nimport rtf\n\n\n\
class Walk(rtf.EpisodeTest):\n    \
    def setup(self, args):\n        \
        with open('log', 'a') as log:\n            \
            print(os.getpid(), self.slots, file=log)\n\n    \
    def episode(self, episode):\n        \
        steps = int(episode.parameter('steps'))\n        \
        for step in range(steps):\n            \
            if steps == 5 and step == 3:\n                BREAK\n            \
            yield 0.1\n        \
        with self.case('arrive'):\n            \
            self.measure('seed', episode.seed)\n            \
            self.check(steps != 4, 'it arrives')\n        \
        return 'too far' if steps == 6 else None\n";

fn campaign(source: &str, attributes: &str, steps: &str) -> Folder {
    let folder = Folder::new();
    folder.file("Walk.py", source);
    let suite = format!("<suite name='walk'><test {attributes}>Walk.py</test></suite>");
    folder.file("walk.xml", &suite);
    let parameter = format!("<parameter name='steps' distribution='grid' values='{steps}'/>");
    let claim = "<claim require='rate &gt;= 0.1' confidence='0.6'/>";
    let campaign = format!("<campaign suite='walk.xml' seed='3'>{parameter}{claim}</campaign>");
    folder.file("campaign.xml", &campaign);
    folder
}

fn walk(problem: &str) -> String {
    WALK.replace("BREAK", problem)
}

fn outcomes(lines: &[EpisodeLine]) -> Vec<EpisodeOutcome> {
    lines.iter().filter_map(|line| line.outcome).collect()
}

fn reason(lines: &[EpisodeLine], episode: u64) -> &str {
    let line = lines.iter().find(|line| line.episode == episode).expect("a result");
    line.reason.as_deref().unwrap_or_default()
}

/// The number of its process, and the slots, of each worker.
fn processes(folder: &Folder) -> usize {
    folder.read("log").lines().count()
}

fn output(finished: &Finished) -> String {
    format!("{}{}", finished.stdout, finished.stderr)
}

#[test]
fn results_are_those_of_one_episode_after_the_other() {
    let mut all = Vec::new();
    for slots in ["1", "3", "64"] {
        let folder = campaign(&walk("pass"), &format!("slots='{slots}'"), "1 2 3 4 5 6 7");
        let finished = run(&folder, &[]);
        assert_eq!(finished.code, Some(0), "{}", output(&finished));
        assert_eq!(processes(&folder), 1);
        let lines = results(&folder);
        let expected = [Passed, Passed, Passed, Failed, Passed, Failed, Passed];
        assert_eq!(outcomes(&lines), expected);
        assert!(reason(&lines, 4).contains("it arrives"), "{lines:?}");
        assert!(reason(&lines, 6).contains("too far"), "{lines:?}");
        for (line, steps) in lines.iter().zip(1..) {
            let value = |name| line.measurements.iter().find(|it| it.name == name)?.value;
            assert_eq!(value("steps"), Some(f64::from(steps)), "{line:?}");
            let time = value("simulated time").expect("a time");
            assert!((time - f64::from(steps) / 10.0).abs() < 1e-6, "{line:?}");
        }
        let lines =
            lines.into_iter().map(|line| EpisodeLine { problem: None, shown: None, ..line });
        all.push(lines.collect::<Vec<_>>());
        assert!(nothing_left(&folder));
    }
    assert!(all[0] == all[1] && all[0] == all[2], "{all:?}");
}

#[test]
fn an_exception_is_an_error_of_its_episode() {
    let folder = campaign(&walk("raise ValueError('42')"), "slots='3'", "1 5 3 2");
    let finished = run(&folder, &[]);
    let lines = results(&folder);
    assert_eq!(outcomes(&lines), [Passed, Error, Passed, Passed], "{}", output(&finished));
    assert!(reason(&lines, 2).contains("ValueError: 42"), "{lines:?}");
    assert_eq!(processes(&folder), 1);
}

/// It is unknown which of the open ones is to blame until each has run alone.
#[test]
fn a_crash_is_that_of_one_episode() {
    for problem in ["os.abort()", "os._exit(0)", "os.kill(os.getpid(), 9)"] {
        let folder = campaign(&walk(problem), "slots='3'", "7 5 8 2");
        let finished = run(&folder, &[]);
        let lines = results(&folder);
        let expected = [Passed, Failed, Passed, Passed];
        assert_eq!(outcomes(&lines), expected, "{problem}: {}", output(&finished));
        assert!(processes(&folder) > 1);
        assert!(nothing_left(&folder));
    }
}

#[test]
fn an_episode_that_hangs_is_one_that_has_failed() {
    let folder = campaign(&walk("self.sleep(1000)"), "slots='2' timeout='2s'", "1 5 2");
    let finished = run(&folder, &[]);
    let lines = results(&folder);
    assert_eq!(outcomes(&lines), [Passed, Failed, Passed], "{}", output(&finished));
    assert!(reason(&lines, 2).contains("episode 2 did not end within 2s"), "{lines:?}");
}

#[test]
fn limits_in_steps_and_simulated_time() {
    let limits =
        [("max-steps='4'", "not done after 4 steps"), ("max-time='400ms'", "not done after 0.4 s")];
    for (limit, text) in limits {
        let folder = campaign(&walk("pass"), &format!("slots='2' {limit}"), "1 7 4 2");
        let finished = run(&folder, &[]);
        let lines = results(&folder);
        assert_eq!(outcomes(&lines), [Passed, Failed, Failed, Passed], "{}", output(&finished));
        assert!(reason(&lines, 2).contains(text), "{lines:?}");
        assert!(reason(&lines, 3).contains("it arrives"), "{lines:?}");
    }
}

#[test]
fn a_run_that_ends_early_is_an_error() {
    let source = "import rtf\n\n\nclass Walk(rtf.EpisodeTest):\n    def run(self):\n        \
                  self.take(1)[0].finish(True)\n";
    let folder = campaign(source, "slots='1'", "1 2 3");
    let finished = run(&folder, &[]);
    assert!(output(&finished).contains("more episodes follow"), "{}", output(&finished));
    assert!(nothing_left(&folder));
}

#[test]
fn without_a_campaign_there_is_one_episode() {
    let folder = campaign(&walk("pass"), "slots='4'", "1");
    let finished = folder.rtf(&["run", "walk.xml", "--set", "steps=2"]);
    assert_eq!(finished.code, Some(0), "{}", output(&finished));
    let finished = folder.rtf(&["run", "walk.xml", "--set", "steps=4"]);
    assert_eq!(finished.code, Some(1), "{}", output(&finished));
    assert!(finished.stdout.contains("it arrives"), "{}", output(&finished));
}

/// The class and the suite say the same about slots.
#[test]
fn a_suite_that_does_not_fit_the_class() {
    let folder = campaign(&walk("pass"), "", "1");
    let finished = folder.rtf(&["run", "walk.xml"]);
    let text = "`Walk` is an episode test, which needs `slots`: `<test slots=\"1\">`";
    assert!(finished.stdout.contains(text), "{}", output(&finished));
    let plain = "import rtf\n\n\nclass Walk(rtf.TestCase):\n    def run(self):\n        pass\n";
    let finished = folder_with(plain).rtf(&["run", "walk.xml"]);
    let text = "the test has `slots`, but `Walk` is not derived from `rtf.EpisodeTest`";
    assert!(finished.stdout.contains(text), "{}", output(&finished));
}

fn folder_with(source: &str) -> Folder {
    campaign(source, "slots='2'", "1")
}
