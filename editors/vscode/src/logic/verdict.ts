// How verdicts are shown in the Test Explorer. The rules for known failures are those of
// rtf_model::ExpectedFailure.

import type { ExpectedFailure, Verdict } from './events';

/** The states of a test item. */
export type Outcome = 'passed' | 'failed' | 'errored' | 'skipped';

/** The outcome of a verdict, and a note if a known failure or a rule about skips decides. */
export interface Judgement {
    outcome: Outcome;
    note?: string;
}

/** The outcome of a verdict without known failures. */
export function outcomeOf(verdict: Verdict): Outcome {
    switch (verdict) {
        case 'passed':
        case 'failed':
        case 'skipped':
            return verdict;
        default:
            return 'errored';
    }
}

/** Whether a verdict is a problem of the test. */
export function isBad(verdict: Verdict): boolean {
    return verdict !== 'passed' && verdict !== 'skipped';
}

/** Judges the final verdict of a test. */
export function judge(
    verdict: Verdict,
    expected: ExpectedFailure | null | undefined,
    skipsFail: boolean,
): Judgement {
    if (verdict === 'skipped' && skipsFail) {
        return { outcome: 'failed', note: 'skipped, which makes the run red' };
    }
    if (expected == null || expected.expired === true) return { outcome: outcomeOf(verdict) };
    if (verdict === 'passed' && expected.quarantined !== true) {
        return {
            outcome: 'failed',
            note: 'passed although a failure is expected: remove the mark',
        };
    }
    if (!expected.verdicts.includes(verdict)) return { outcome: outcomeOf(verdict) };
    const why = [expected.issue, expected.reason].filter(Boolean).join(', ');
    return { outcome: 'passed', note: `known failure${why === '' ? '' : `: ${why}`}` };
}
