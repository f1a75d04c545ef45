//! Processes of a campaign are killed at random: each listed episode has exactly one final result,
//! that of the undisturbed run.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use rtf_report::episode_results::EpisodeLine;

use crate::campaign::results;
use crate::support::{Folder, Random, kill, nothing_left, number, wait_until};

/// The result depends on the seed only. Each step takes a moment, so that kills hit open episodes.
const WALK: &str = "import random\nimport time\nimport rtf\n\n\nclass Walk(rtf.EpisodeTest):\n    \
    def episode(self, episode):\n        \
    chance = random.Random(episode.seed)\n        \
    x = 0.0\n        \
    for _ in range(chance.randrange(3, 9)):\n            \
    x += chance.uniform(-1, 1)\n            \
    time.sleep(0.0005)\n            \
    yield 0.01\n        \
    self.measure('x', x, 'm')\n        \
    return abs(x) < 1 or f'x is {x:.3f}'\n";

fn campaign() -> Folder {
    let folder = Folder::new();
    folder.file("Walk.py", WALK);
    folder.file("walk.xml", "<suite name='walk'><test slots='8'>Walk.py</test></suite>");
    folder.file(
        "campaign.xml",
        "<campaign suite='walk.xml' episodes='400' repeats='1000'>\
         <claim require='rate &gt;= 0.1' confidence='0.6'/></campaign>",
    );
    folder
}

/// The results apart from what depends on the machine.
fn comparable(folder: &Folder) -> Vec<(EpisodeLine, String)> {
    let line = |line: EpisodeLine| {
        let observed = format!("{:?}", line.measurements);
        (EpisodeLine { measurements: Vec::new(), ..line }, observed)
    };
    results(folder).into_iter().map(line).collect()
}

pub fn directory(folder: &Folder) -> PathBuf {
    folder.path().join("rtf-results/campaigns/latest")
}

/// How many results there are, in all workers.
pub fn progress(folder: &Folder) -> usize {
    let workers = directory(folder).join("workers");
    let runs = workers.read_dir().into_iter().flatten().flatten();
    let runs = runs.flat_map(|worker| worker.path().read_dir().into_iter().flatten().flatten());
    let files = runs.filter(|run| run.file_name() != "latest").map(|run| run.path());
    let count = |run: PathBuf| {
        let text = std::fs::read_to_string(run.join("episodes.jsonl")).unwrap_or_default();
        text.matches("\"outcome\"").count()
    };
    files.map(count).sum()
}

/// The processes of rtf below one, the nearest first: its runner, and guards and runners of workers.
pub fn below(pid: u32) -> Vec<u32> {
    let mut found = vec![pid];
    let mut next = 0;
    while let Some(parent) = found.get(next).copied() {
        next += 1;
        let tasks = Path::new("/proc").join(parent.to_string()).join("task");
        for task in tasks.read_dir().into_iter().flatten().flatten() {
            let children = std::fs::read_to_string(task.path().join("children"));
            found.extend(
                children
                    .unwrap_or_default()
                    .split_whitespace()
                    .filter_map(|it| it.parse::<u32>().ok()),
            );
        }
    }
    let is_rtf = |pid: &u32| {
        let program = std::fs::read_link(format!("/proc/{pid}/exe"));
        program.is_ok_and(|program| program.file_name().is_some_and(|name| name == "rtf"))
    };
    found.into_iter().filter(is_rtf).collect()
}

fn start(folder: &Folder, args: &[&str]) -> Child {
    let mut command: Command = folder.command(args);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("rtf starts")
}

#[test]
fn killed_processes_change_no_result() {
    let undisturbed = campaign();
    let args = ["campaign", "run", "campaign.xml", "--workers", "2", "--no-history"];
    undisturbed.rtf(&args);
    let expected = comparable(&undisturbed);
    assert_eq!(expected.len(), 400);
    let folder = campaign();
    let mut random = Random::from_environment();
    let mut running = start(&folder, &args);
    wait_until("the campaign", || directory(&folder).join("campaign.json").exists().then_some(()));
    for _ in 0..number("RTF_KILLS").unwrap_or(15) {
        let wanted = progress(&folder) + random.below(40) as usize;
        let mut has_ended = false;
        wait_until("results", || {
            has_ended = running.try_wait().expect("a child").is_some();
            (has_ended || progress(&folder) >= wanted).then_some(())
        });
        if !has_ended {
            let all = below(running.id());
            let victim = all[random.below(all.len() as u64) as usize];
            kill(victim);
            if victim != running.id() {
                continue;
            }
        }
        running.wait().expect("it ends");
        let latest = "rtf-results/campaigns/latest";
        running = start(&folder, &["campaign", "run", "--resume", latest, "--no-history"]);
    }
    running.wait().expect("it ends");
    let latest = "rtf-results/campaigns/latest";
    let resumed = folder.rtf(&["campaign", "run", "--resume", latest, "--no-history"]);
    assert_eq!(resumed.code, Some(0), "{}{}", resumed.stdout, resumed.stderr);
    assert_eq!(comparable(&folder), expected);
    assert!(nothing_left(&folder));
}
