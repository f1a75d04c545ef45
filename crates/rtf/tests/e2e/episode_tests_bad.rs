//! Tests with slots that go wrong, and their campaigns.

use std::process::{Child, Stdio};

use rtf_model::EpisodeOutcome::{Failed, Passed};
use rtf_report::episode_results::EpisodeLine;

use crate::campaign::{results, run};
use crate::campaign_kills::{below, directory, progress};
use crate::support::{Folder, kill, nothing_left, wait_until};

/// All episodes of a batch are open before the first one ends, while there is no file `go`.
const BATCH: &str = "import os\nimport time\nimport rtf\n\n\nclass Batch(rtf.EpisodeTest):\n    \
    def run(self):\n        \
    while episodes := self.take():\n            \
    while len(episodes) < self.slots and (more := self.take(wait=False)):\n                \
    episodes += more\n            \
    while not os.path.exists('go'):\n                time.sleep(0.01)\n            \
    for episode in episodes:\n                \
    episode.finish(episode.seed % 4 > 0, steps=1)\n";

fn campaign(test: &str, slots: u32, episodes: u32) -> Folder {
    let folder = Folder::new();
    folder.file("T.py", test);
    let suite = format!(
        "<suite name='batch'><test slots='{slots}' timeout='3s' grace='200ms'>T.py</test></suite>"
    );
    folder.file("batch.xml", &suite);
    let claim = "<claim require='rate &gt;= 0.1' confidence='0.6'/>";
    folder.file(
        "campaign.xml",
        &format!("<campaign suite='batch.xml' episodes='{episodes}'>{claim}</campaign>"),
    );
    folder
}

fn start(folder: &Folder) -> Child {
    let mut command = folder.command(&["campaign", "run", "campaign.xml", "--no-history"]);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("rtf starts")
}

/// How many episodes have started.
fn started(folder: &Folder) -> usize {
    let all = directory(folder).join("workers/1/latest/episodes.jsonl");
    std::fs::read_to_string(all).unwrap_or_default().lines().count()
}

#[test]
fn a_worker_that_is_killed_with_a_thousand_episodes_loses_none() {
    let folder = campaign(BATCH, 1024, 1200);
    let suite = folder.read("batch.xml").replace("timeout='3s'", "timeout='60s'");
    folder.file("batch.xml", &suite);
    let mut running = start(&folder);
    wait_until("the episodes", || (started(&folder) >= 1024).then_some(()));
    assert_eq!(progress(&folder), 0);
    let runner = below(running.id()).pop().expect("the runner of the worker");
    folder.file("go", "");
    kill(runner);
    assert!(running.wait().expect("it ends").success());
    let results: Vec<EpisodeLine> = results(&folder);
    assert!(results.iter().map(|line| line.episode).eq(1..=1200));
    let list = folder.read("rtf-results/campaigns/latest/episodes.jsonl");
    for (line, episode) in results.iter().zip(list.lines()) {
        let episode: rtf_model::Episode = serde_json::from_str(episode).expect("an episode");
        let expected = if episode.seed % 4 > 0 { Passed } else { Failed };
        assert_eq!(line.outcome, Some(expected), "{}", episode.id);
    }
    assert!(nothing_left(&folder));
}

#[test]
fn more_slots_than_episodes_run_all_of_them() {
    let folder = campaign(BATCH, 64, 5);
    folder.file("go", "");
    let finished = run(&folder, &[]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(results(&folder).len(), 5);
}

#[test]
fn a_policy_that_prints_without_end_is_one_failed_episode() {
    let test = "import rtf\n\n\nclass Talks(rtf.EpisodeTest):\n    \
        def run(self):\n        \
        while episodes := self.take():\n            \
        for episode in episodes:\n                \
        while episode.id == 3:\n                    print('thinking' * 100)\n                \
        episode.finish(True)\n";
    let folder = campaign(test, 4, 8);
    let finished = run(&folder, &[]);
    assert!(
        finished.stdout.contains("lost with others in a process that ended"),
        "{}",
        finished.stdout
    );
    let results = results(&folder);
    let outcomes: Vec<_> = results.iter().filter_map(|line| line.outcome).collect();
    assert_eq!(outcomes, [Passed, Passed, Failed, Passed, Passed, Passed, Passed, Passed]);
    let reason = results[2].reason.as_deref().unwrap_or_default();
    assert!(reason.contains("episode 3 did not end within 3s"), "{reason}");
    assert!(nothing_left(&folder));
}

#[test]
fn a_second_process_does_not_run_the_same_campaign() {
    let folder = campaign(BATCH, 4, 8);
    let mut running = start(&folder);
    wait_until("the episodes", || (started(&folder) >= 4).then_some(()));
    let second = folder.rtf(&["campaign", "run", "--resume", "rtf-results/campaigns/latest"]);
    assert_eq!(second.code, Some(2), "{}", second.stdout);
    assert!(second.stderr.contains("is still running"), "{}", second.stderr);
    folder.file("go", "");
    assert!(running.wait().expect("it ends").success());
    assert_eq!(results(&folder).len(), 8);
}

#[test]
fn what_does_not_fit_is_refused_before_anything_starts() {
    let folder = campaign(BATCH, 4, 8);
    let suite = folder.read("batch.xml");
    folder.file("batch.xml", &suite.replace("grace=", "param='${param:mass}' grace="));
    let text = folder.read("campaign.xml");
    let parameter = "<parameter name='mass' distribution='grid' values='1 2'/><claim";
    folder.file("campaign.xml", &text.replace("<claim", parameter));
    let refused = run(&folder, &[]);
    assert_eq!(refused.code, Some(2), "{}", refused.stdout);
    assert!(refused.stderr.contains("a parameter of the campaign in a text"), "{}", refused.stderr);
    folder.file("batch.xml", &suite.replace("slots='4'", ""));
    let refused = run(&folder, &["--slots", "8"]);
    assert_eq!(refused.code, Some(2), "{}", refused.stdout);
    assert!(refused.stderr.contains("`--slots` needs a test with `slots`"), "{}", refused.stderr);
    assert!(!folder.path().join("rtf-results").exists());
}
