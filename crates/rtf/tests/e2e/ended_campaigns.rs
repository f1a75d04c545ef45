//! Campaigns that end before all episodes have run, and continue.

use crate::campaign::{GRASP, SUITE, fixed, folder, results, run};
use crate::support::{Folder, kill, nothing_left, wait_until};

/// Each episode takes 50 ms.
fn slow() -> Folder {
    let folder = folder(SUITE, &fixed(60, "0.5"));
    let test = GRASP.replace("  rtf.check", "  rtf.sleep(0.05)\n  rtf.check");
    folder.file("Grasp.lua", &test);
    folder
}

fn lines_of_first_worker(folder: &Folder) -> usize {
    let file = folder.path().join("rtf-results/campaigns/latest/workers/1/latest/episodes.jsonl");
    std::fs::read_to_string(file).map_or(0, |text| text.lines().count())
}

fn resume(folder: &Folder) {
    let undisturbed = slow();
    run(&undisturbed, &["--workers", "2"]);
    let finished = folder.rtf(&[
        "campaign",
        "run",
        "--workers",
        "2",
        "--resume",
        "rtf-results/campaigns/latest",
    ]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(results(folder), results(&undisturbed), "each episode has its result, once");
    assert!(nothing_left(folder));
}

#[test]
fn a_campaign_is_interrupted_and_resumed() {
    let folder = slow();
    let running = folder.start(&["campaign", "run", "campaign.xml", "--workers", "2"]);
    wait_until("some episodes", || (lines_of_first_worker(&folder) > 10).then_some(()));
    let twice = folder.rtf(&["campaign", "run", "--resume", "rtf-results/campaigns/latest"]);
    assert_eq!(twice.code, Some(2), "{}", twice.stdout);
    assert!(twice.stderr.contains("is still running"), "{}", twice.stderr);
    running.signal("INT");
    let finished = running.finish();
    assert_eq!(finished.code, Some(130), "{}", finished.stdout);
    assert!(finished.stdout.contains("rtf campaign run --resume "), "{}", finished.stdout);
    assert!(nothing_left(&folder));
    resume(&folder);
}

#[test]
fn a_campaign_that_is_killed_leaves_nothing_and_is_resumed() {
    let folder = slow();
    let running = folder.start(&["campaign", "run", "campaign.xml", "--workers", "2"]);
    wait_until("some episodes", || (lines_of_first_worker(&folder) > 10).then_some(()));
    running.signal("KILL");
    running.finish();
    resume(&folder);
}

/// The results so far are judged, and the rest can be run later.
#[test]
fn a_budget_ends_a_campaign() {
    let folder = slow();
    let campaign = fixed(400, "0.5");
    let text = format!("<campaign budget='3s' suite='grasp.xml' {campaign}</campaign>");
    folder.file("campaign.xml", &text);
    let finished = run(&folder, &[]);
    assert_eq!(finished.code, Some(6), "{}{}", finished.stdout, finished.stderr);
    let expected =
        "  ended early: the budget of 3s has passed\n  continue: rtf campaign run --resume";
    assert!(finished.stdout.contains(expected), "{}", finished.stdout);
    let before = results(&folder).len();
    assert!(before > 0);
    let resumed = folder.rtf(&["campaign", "run", "--resume", "rtf-results/campaigns/latest"]);
    assert_eq!(resumed.code, Some(6), "{}", resumed.stderr);
    assert!(results(&folder).len() > before);
    assert!(nothing_left(&folder));
}

/// The first child of a process.
pub fn first_child(pid: u32) -> Option<u32> {
    let children = std::fs::read_to_string(format!("/proc/{pid}/task/{pid}/children")).ok()?;
    children.split_whitespace().next()?.parse().ok()
}

#[test]
fn the_episode_of_a_worker_that_dies_is_repeated() {
    let folder = slow();
    let running = folder.start(&["campaign", "run", "campaign.xml"]);
    wait_until("some episodes", || (lines_of_first_worker(&folder) > 10).then_some(()));
    let guard = first_child(running.child.id()).expect("the guard of the worker");
    assert!(kill(first_child(guard).expect("the runner")));
    let finished = running.finish();
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let died = "worker 1 ended with exit code 5";
    assert!(finished.stdout.contains(died), "{}", finished.stdout);
    assert_eq!(results(&folder).len(), 60);
    assert!(nothing_left(&folder));
}
