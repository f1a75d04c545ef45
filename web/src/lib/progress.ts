// Estimates the remaining time of a run.

import type { Test } from './api-types';
import type { RunRecord } from './record/record';

/** Durations of tests in another run, by `suite/test`, in microseconds. */
export type History = ReadonlyMap<string, number>;

export function historyOf(record: RunRecord): History {
    const history = new Map<string, number>();
    for (const test of record.tests) {
        if (test.verdict === undefined || test.verdict === 'skipped') continue;
        history.set(fullName(record, test), test.duration_us);
    }
    return history;
}

export function fullName(record: RunRecord, test: Test): string {
    return `${record.suites[test.suite]?.name ?? ''}/${test.name}`;
}

/**
 * The remaining seconds until the last test has finished, and the basis of the estimate: each
 * unfinished test is expected to take as long as in the last run, or as long as the average test
 * of this run. `null` without any data.
 */
export function estimate(record: RunRecord, now: number, history: History) {
    let spent = 0;
    let repetitions = 0;
    for (const test of record.tests) {
        for (const { started, finished } of test.attempts) {
            if (finished === undefined) continue;
            spent += finished - started;
            repetitions += 1;
        }
    }
    const average = repetitions === 0 ? null : spent / repetitions;
    let left = 0;
    let known = 0;
    let open = 0;
    for (const test of record.tests) {
        if (test.state === 'done') continue;
        if (test.timed === true) return null;
        open += 1;
        const before = history.get(fullName(record, test));
        if (before !== undefined) known += 1;
        const whole = before ?? (average === null ? null : average * test.repetitions);
        if (whole === null) return null;
        const running = test.attempts.at(-1);
        const current = running && running.finished === undefined ? now - running.started : 0;
        left += Math.max(0, whole - test.duration_us - current);
    }
    return { seconds: left / 1e6, basis: known * 2 > open ? 'last run' : 'this run' };
}
