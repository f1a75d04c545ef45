//! Fixtures of many suites are killed at random moments, during set-up, tests and tear-down, in
//! every host mode.
//!
//! `RTF_CHAOS_SUITES` sets the number of suites (`make chaos` runs more), and `RTF_CHAOS_SEED`
//! repeats the random numbers of a run, which prints its seed.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rtf_model::{Record, Verdict};

use crate::host_modes::{FORKED, Mode, PROCESS, SHARED};
use crate::support::{Folder, Random, kill, nothing_left, number};

const SUITES: u64 = 200;
/// Tells which of its fixtures is gone when it has run.
const TEST: &str = r#"
local function is_gone(name)
  local pid = io.open(rtf.param() .. "." .. name .. ".pid"):read("n")
  return function()
    local stat = io.open("/proc/" .. pid .. "/stat")
    return not stat or stat:read("a"):match("%) ([ZX])") ~= nil
  end
end

TestCase = {}
function TestCase.run()
  local fixtures = { is_gone("driver"), is_gone("simulator") }
  rtf.sleep(0.05)
  for _, gone in ipairs(fixtures) do
    if gone() then rtf.report("gone") end
  end
end
"#;

fn suite(name: &str, mode: Mode, random: &mut Random) -> String {
    let fixture = |fixture: &str, more: &str| {
        format!(
            "  <fixture type='process' name='{fixture}' restarts='50' restart-delay='1ms' {more}>\n    \
             <command>sh -c 'echo $$ > {name}.{fixture}.pid; echo up; exec sleep 1000'</command>\n    <ready log='up'/>\n  </fixture>\n"
        )
    };
    let independent = if random.below(2) == 0 { "depends=''" } else { "" };
    let rerun = if random.below(2) == 0 { " after-collapse='rerun'" } else { "" };
    let isolation = mode.isolation;
    let tests =
        format!("  <test{rerun} isolation='{isolation}' param='{name}'>T.lua</test>\n").repeat(3);
    let fixtures = fixture("driver", "") + &fixture("simulator", independent);
    format!("<suite name='{name}'>\n{fixtures}{tests}</suite>\n")
}

/// The fixtures' processes: those of this folder that sleep.
fn sleepers(folder: &Path) -> Vec<u32> {
    let entries = std::fs::read_dir("/proc").expect("/proc").flatten();
    let pids = entries.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
    pids.filter(|pid| {
        let of = |file: &str| PathBuf::from(format!("/proc/{pid}/{file}"));
        let sleeps = std::fs::read(of("cmdline")).is_ok_and(|line| line.starts_with(b"sleep\0"));
        sleeps && std::fs::read_link(of("cwd")).is_ok_and(|cwd| cwd == folder)
    })
    .collect()
}

#[test]
fn whoever_is_killed_whenever_the_verdicts_are_true() {
    let mut random = Random::from_environment();
    let suites = number("RTF_CHAOS_SUITES").unwrap_or(SUITES).div_ceil(4);
    // Whether hosts are forked is said to the run, whether they are shared to a test.
    for (modes, suites) in [([PROCESS, SHARED], 2 * suites), ([FORKED, SHARED], 2 * suites)] {
        kill_fixtures(modes, suites, &mut random);
    }
}

fn kill_fixtures(modes: [Mode; 2], suites: u64, random: &mut Random) {
    let folder = Folder::new();
    folder.file("T.lua", TEST);
    let names: Vec<String> = (0..suites).map(|n| format!("{n}.xml")).collect();
    for name in &names {
        let mode = modes[random.below(2) as usize];
        folder.file(name, &suite(name, mode, random));
    }
    let path = folder.path().canonicalize().expect("a path");
    let over = AtomicBool::new(false);
    let finished = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                // Not to wait for something: the moments are what is drawn.
                std::thread::sleep(Duration::from_millis(random.below(300)));
                let victims = sleepers(&path);
                if !victims.is_empty() {
                    let victim = victims[random.below(victims.len() as u64) as usize];
                    kill(victim);
                }
            }
        });
        let mut args = vec!["run", "--fork", modes[0].fork];
        args.extend(names.iter().map(String::as_str));
        let finished = folder.rtf(&args);
        over.store(true, Ordering::Relaxed);
        finished
    });
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    check(&folder.journal().record, names.len());
    assert!(nothing_left(&folder));
}

/// The order of the events was checked when the journal was read.
fn check(record: &Record, suites: usize) {
    let totals = record.totals();
    assert_eq!(totals.done() as usize, 3 * suites, "each test has one last word");
    let collapses: Vec<_> =
        record.fixtures.iter().flat_map(|f| f.collapses.iter().map(|(at, _)| *at)).collect();
    assert!(collapses.len() >= suites / 4, "only {} collapses", collapses.len());
    for test in &record.tests {
        for attempt in &test.attempts {
            let (end, finished) = attempt.finished.as_ref().expect("an end");
            let overlaps = collapses.iter().any(|at| *at > attempt.started && at < end);
            assert!(!overlaps || finished.verdict == Verdict::Collapsed, "{finished:?}");
            let gone = attempt.messages.iter().any(|message| message.text == "gone");
            assert!(!gone || finished.verdict == Verdict::Collapsed, "{finished:?}");
            let expected = [Verdict::Passed, Verdict::Collapsed];
            assert!(expected.contains(&finished.verdict), "{finished:?}");
        }
    }
    // One that broke in its first set-up keeps those after it from being started.
    let restarts: u32 = record.fixtures.iter().map(|f| f.starts.saturating_sub(1)).sum();
    println!("{} collapses, {restarts} restarts", collapses.len());
}
