//! Measures imports and answers over many runs, and checks that what was planted is found.
//!
//! ```text
//! cargo run --release -p rtf-history --example scale [RUNS [TESTS [DIR]]]
//! ```
//!
//! With `DIR`, the database stays there, to be shown by `rtf serve --results DIR`. With the address of
//! an empty PostgreSQL database in `RTF_HISTORY_URL`, its answers must be those of SQLite.

#![expect(clippy::print_stdout, reason = "it prints measurements")]

use std::collections::BTreeSet;
use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use jiff::{SignedDuration, Timestamp};
use rtf_history::store::Location;
use rtf_history::{RunSelection, Store, TestAttributes};
use rtf_model::{
    Event, EventKind, Manifest, Measurement, Micros, Origin, Phase, Record, Revision, RunStarted,
    SuiteId, SuitePlanned, TestFinished, TestId, TestPlanned, Verdict,
};

/// Measurements of each test.
const MEASUREMENTS: u32 = 5;
/// Every so many runs have one commit.
const RUNS_PER_COMMIT: u32 = 4;
/// One of so many tests is flaky, and one of so many has a regression.
const PLANTED: u32 = 50;

/// Random numbers that do not change (SplitMix64).
struct Random(u64);

impl Random {
    /// Between 0 and 1.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Around 0, with the deviation 1.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

fn is_flaky(test: u32) -> bool {
    test % PLANTED == 7
}

/// The run from which a test's first measurement is 10 % larger.
fn regression(test: u32, runs: u32) -> Option<u32> {
    (test % PLANTED == 13).then(|| runs / 4 + (test * 37) % (runs / 2))
}

fn started(run: u32, tests: u32) -> RunStarted {
    let commit = format!("{:040x}", run / RUNS_PER_COMMIT);
    let revision = Revision { commit, branch: Some("main".to_owned()), ..Revision::default() };
    let origin = Origin { id: format!("run-{run}"), host: "bench".to_owned(), ..Origin::default() };
    let at = Timestamp::UNIX_EPOCH + SignedDuration::from_mins(i64::from(run));
    RunStarted {
        version: 1,
        run: format!("run-{run:06}"),
        rtf: "0".to_owned(),
        started_at: at.to_string(),
        command: Vec::new(),
        working_dir: "/robot".to_owned(),
        suites: 1,
        tests,
        manifest: Box::new(Manifest {
            revision: Some(revision),
            origin: Some(origin),
            ..Manifest::default()
        }),
    }
}

/// The plan of a run.
fn planned(run: u32, tests: u32) -> Vec<EventKind> {
    let suite = SuitePlanned {
        suite: SuiteId(0),
        name: "arm".to_owned(),
        file: "arm.xml".to_owned(),
        description: String::new(),
        environment: String::new(),
        tolerates_collapse: false,
        skips_fail: false,
        parallel: 1,
        requires: vec!["robot:icub".to_owned()],
    };
    let test = |test| {
        EventKind::TestPlanned(TestPlanned {
            learned: Vec::new(),
            test: TestId(test),
            suite: SuiteId(0),
            name: format!("Test{test:04}"),
            plugin_type: "dll".to_owned(),
            plugin: String::new(),
            plugin_hash: None,
            source_hash: None,
            repetitions: 1,
            timed: false,
            tags: Vec::new(),
            parameters: Vec::new(),
            was: None,
            expected: None,
        })
    };
    let start = [EventKind::RunStarted(started(run, tests)), EventKind::SuitePlanned(suite)];
    start.into_iter().chain((0..tests).map(test)).collect()
}

/// A run with all its events applied.
fn record(run: u32, runs: u32, tests: u32, random: &mut Random) -> Record {
    let mut record = Record::default();
    let mut seq = 0;
    let mut apply = |at: u64, kind: EventKind| {
        record.apply(&Event { seq, at: Micros(at), kind });
        seq += 1;
    };
    planned(run, tests).into_iter().for_each(|kind| apply(0, kind));
    let mut at = 0;
    for test in 0..tests {
        let id = TestId(test);
        apply(at, EventKind::TestStarted { test: id, repetition: 1, attempt: 1 });
        for number in 0..MEASUREMENTS {
            let has_changed = number == 0 && regression(test, runs).is_some_and(|from| run >= from);
            let centre = if has_changed { 11.0 } else { 10.0 };
            let measurement = Measurement {
                learned: false,
                name: format!("value {number}"),
                value: Some(centre + 0.1 * random.normal()),
                unit: "ms".to_owned(),
                low: None,
                high: None,
                location: None,
                case: None,
            };
            apply(at, EventKind::Measured { test: id, fixture: None, measurement });
        }
        at += 100_000 + (5000.0 * random.normal()).max(-50_000.0) as u64;
        let fails = is_flaky(test) && random.unit() < 0.1;
        let verdict = if fails { Verdict::Failed } else { Verdict::Passed };
        let (reason, phase) = (fails.then(|| "planted".to_owned()), Phase::Run);
        let (decided_by, exit, rerun) = (None, None, false);
        let finished = TestFinished { test: id, verdict, reason, phase, decided_by, exit, rerun };
        apply(at, EventKind::TestFinished(finished));
    }
    apply(at, EventKind::RunFinished { interrupted: None });
    record
}

/// The time that this thread has used a processor: other processes affect it little, unlike the
/// elapsed time.
fn cpu_ms() -> f64 {
    let spent = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanos = spent.split(' ').next().and_then(|nanos| nanos.parse::<f64>().ok());
    nanos.unwrap_or(f64::NAN) / 1e6
}

fn timed<T>(
    what: &str,
    act: impl FnOnce() -> Result<T, Box<dyn Error>>,
) -> Result<T, Box<dyn Error>> {
    let (start, cpu) = (Instant::now(), cpu_ms());
    let answer = act()?;
    let (elapsed, cpu) = (start.elapsed().as_secs_f64() * 1e3, cpu_ms() - cpu);
    println!("{what:<28} {elapsed:>8.1} ms, CPU {cpu:>8.1} ms");
    Ok(answer)
}

fn check(
    what: &str,
    found: &BTreeSet<String>,
    planted: &BTreeSet<String>,
) -> Result<(), Box<dyn Error>> {
    let missed: Vec<_> = planted.difference(found).collect();
    let wrong: Vec<_> = found.difference(planted).collect();
    println!("{what}: {} planted, missed {missed:?}, wrong {wrong:?}", planted.len());
    if missed.is_empty() && wrong.is_empty() { Ok(()) } else { Err(what.into()) }
}

fn import(name: &str, store: &mut Store, (runs, tests): (u32, u32)) -> Result<(), Box<dyn Error>> {
    let mut random = Random(1);
    let (mut importing, mut slowest) = (0.0, 0.0_f64);
    for run in 0..runs {
        let record = record(run, runs, tests, &mut random);
        let start = Instant::now();
        store.import(&record)?;
        let seconds = start.elapsed().as_secs_f64();
        importing += seconds;
        slowest = slowest.max(seconds);
    }
    println!("{name}: {runs} runs, {tests} tests, {MEASUREMENTS} measurements");
    println!("import: {:.1} runs/s, slowest {:.0} ms", f64::from(runs) / importing, slowest * 1e3);
    Ok(())
}

/// Measures all questions, and checks that what was planted is found; the answers as JSON.
fn ask(store: &Store, (runs, tests): (u32, u32)) -> Result<Vec<String>, Box<dyn Error>> {
    let all = RunSelection::default();
    let any = |_: &TestAttributes| true;
    let one = |test: &TestAttributes| test.identity.test == "Test0013";
    let latest = RunSelection { last: Some(1), ..all.clone() };
    let listed = timed("runs", || Ok(store.runs(&all)?))?;
    let shown = timed("show", || Ok(store.test_histories(&all, &one)?))?;
    let flaky = timed("flaky", || Ok(store.flaky(&all, &any)?))?;
    let slow = timed("slow", || Ok(store.slow(&all, &any)?))?;
    let trend = timed("trend of one test", || Ok(store.trend("value 0", None, &all, &one)?))?;
    let compare = || Ok(store.compare((&latest, &all), &any)?);
    let compared = timed("compare latest with all", compare)?;
    let changes = timed("changes", || Ok(store.changes(&all, &any)?))?;
    let name = |test: u32| format!("Test{test:04}");
    let planted = (0..tests).filter(|test| is_flaky(*test)).map(name).collect();
    check("flaky", &flaky.tests.iter().map(|it| it.identity.test.clone()).collect(), &planted)?;
    let large = changes.iter().filter(|it| {
        it.series.is_some() && it.change.size.is_none_or(|size| size.fraction.abs() >= 0.05)
    });
    let planted = (0..tests).filter(|test| regression(*test, runs).is_some()).map(name).collect();
    check("changes", &large.map(|it| it.identity.test.clone()).collect(), &planted)?;
    Ok(vec![
        serde_json::to_string(&listed)?,
        serde_json::to_string(&shown)?,
        serde_json::to_string(&flaky)?,
        serde_json::to_string(&slow)?,
        serde_json::to_string(&trend)?,
        serde_json::to_string(&compared)?,
        serde_json::to_string(&changes)?,
    ])
}

fn main() -> Result<(), Box<dyn Error>> {
    let kept = std::env::args_os().nth(3).map(PathBuf::from);
    let mut args = std::env::args().skip(1).take(2).map(|arg| arg.parse::<u32>());
    let runs = args.next().transpose()?.unwrap_or(1000);
    let tests = args.next().transpose()?.unwrap_or(500);
    let dir = tempfile::tempdir()?;
    let path = kept.as_deref().unwrap_or(dir.path()).join("history.db");
    let mut sqlite = Store::open(&path)?;
    import("SQLite", &mut sqlite, (runs, tests))?;
    println!("size: {} MiB", path.metadata()?.len() >> 20);
    let answers = ask(&sqlite, (runs, tests))?;
    if let Ok(address) = std::env::var("RTF_HISTORY_URL") {
        let mut postgres = Store::open(Location::postgres(&address)?)?;
        import("PostgreSQL", &mut postgres, (runs, tests))?;
        if ask(&postgres, (runs, tests))? != answers {
            return Err("PostgreSQL has other answers than SQLite".into());
        }
        println!("PostgreSQL: equal answers");
    }
    Ok(())
}
