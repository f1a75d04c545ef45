//! The exit code that a run implies.

use std::process::ExitCode;

use rtf_engine::signal;
pub use rtf_model::exit_code::{
    BAD_INPUT, BROKEN, FAILED, HOOK_FAILED, PASSED, RUNNER_DIED, UNDECIDED,
};
use rtf_model::{Record, TestRecord, Verdict};

/// `rtf show --single-test`: the test skipped itself. Automake and CTest know this code.
const SKIPPED: u8 = 77;

pub fn of_run(record: &Record) -> ExitCode {
    of_result(record, record.is_green())
}

/// The exit code of an array of tasks with their merged run: whether a signal stopped them, and
/// whether a task has no result.
pub fn of_array(record: Option<&Record>, stopped_by: Option<i32>, is_lost: bool) -> ExitCode {
    match (record, stopped_by) {
        (Some(record), _) if record.hook_failed() => ExitCode::from(HOOK_FAILED),
        (_, Some(signal)) => ExitCode::from(of_signal(signal)),
        (_, None) if is_lost => ExitCode::from(RUNNER_DIED),
        (Some(record), None) => of_run(record),
        (None, None) => ExitCode::from(BROKEN),
    }
}

/// The exit code of a run apart from its tests.
pub fn without_tests(record: &Record) -> ExitCode {
    of_result(record, record.is_green_without_tests())
}

pub fn of_test(record: &Record, test: &TestRecord) -> ExitCode {
    let is_green = !record.is_damaged() && record.has_green_result(test);
    ExitCode::from(match test.final_verdict() {
        Verdict::Skipped if is_green => SKIPPED,
        _ if is_green => PASSED,
        _ => FAILED,
    })
}

fn of_result(record: &Record, is_green: bool) -> ExitCode {
    let interrupted = record.interrupted().map(|by| signal::exit_code(by).unwrap_or(FAILED));
    ExitCode::from(match interrupted {
        _ if record.hook_failed() => HOOK_FAILED,
        // The record may be incomplete.
        _ if record.is_damaged() => FAILED,
        _ if record.runner_death().is_some() => RUNNER_DIED,
        Some(code) => code,
        None if is_green => PASSED,
        None => FAILED,
    })
}

/// The exit code of a process that signal `number` ended, as shells report it.
pub fn of_signal(number: i32) -> u8 {
    u8::try_from(128 + number).unwrap_or(BROKEN)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// The golden table, with which console, JUnit and TAP agree as well.
    #[test]
    fn the_exit_code_of_each_verdict_with_each_mark() {
        let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("../rtf-report/tests");
        let table = std::fs::read_to_string(dir.join("golden/verdicts.txt")).unwrap();
        let rows: Vec<_> = table.lines().filter(|line| !line.starts_with('#')).collect();
        let stream = dir.join("streams/known-failures.jsonl");
        let all = rtf_report::journal::read(&stream).unwrap().record;
        assert_eq!(rows.len(), all.tests.len());
        for (row, test) in rows.iter().zip(&all.tests) {
            let mut one = all.clone();
            one.tests = vec![test.clone()];
            let columns: Vec<_> = row.split_whitespace().take(2).collect();
            let code = format!("{:?}", of_run(&one));
            let wanted = format!("{:?}", ExitCode::from(columns[1].parse::<u8>().unwrap()));
            assert_eq!((columns[0], code), (test.plan.name.as_str(), wanted));
            let skipped = columns[0].ends_with("-skipped") && columns[0] != "case-skipped";
            let wanted = if skipped { SKIPPED } else { columns[1].parse().unwrap() };
            let code = format!("{:?}", of_test(&all, test));
            assert_eq!(code, format!("{:?}", ExitCode::from(wanted)), "{}", columns[0]);
            assert_eq!(format!("{:?}", without_tests(&one)), format!("{:?}", ExitCode::SUCCESS));
        }
    }
}
