// Known failures of tests. The rules are those of rtf_model::ExpectedFailure.

import type { Suite, Test } from './api-types';
import type { Verdict } from './event';

export type Significance = NonNullable<Test['significance']>;

/** Filters of tests by their known failure. */
export const MARKS = ['expected', 'quarantined'] as const;
export type Mark = (typeof MARKS)[number];

/** How a test is marked; an expired mark does not apply. */
export function markOf({ expected }: Test): Mark | null {
    if (expected === undefined || expected.expired === true) return null;
    return expected.quarantined === true ? 'quarantined' : 'expected';
}

/** The meaning of a final verdict, if it does not count like that of any other test.
 *  `skippedItself`: the runner did not skip it. */
export function significanceOf(
    { expected }: Pick<Test, 'expected'>,
    verdict: Verdict,
    skippedItself: boolean,
): Significance | null {
    if (verdict === 'skipped' && skippedItself) return 'skipped-itself';
    if (expected === undefined || expected.expired === true) return null;
    const isQuarantined = expected.quarantined === true;
    if (verdict === 'passed') return isQuarantined ? 'quarantined' : 'unexpected-pass';
    if (!expected.verdicts.includes(verdict)) return null;
    return isQuarantined ? 'quarantined' : 'expected';
}

/** Whether `rtf run --rerun failed` reruns a test of a run that has ended: it made the run
 *  red, and the runner neither skipped nor interrupted it. */
export function isRerunAsFailed(test: Pick<Test, 'green' | 'verdict' | 'significance'>): boolean {
    const isUndecided = test.verdict === 'skipped' || test.verdict === 'interrupted';
    return test.green === false && (!isUndecided || test.significance === 'skipped-itself');
}

/** Whether a final verdict leaves the run green, apart from cases that skipped themselves. */
export function isGreenVerdict(
    verdict: Verdict,
    significance: Significance | null,
    suite: Pick<Suite, 'skips_fail'> | undefined,
): boolean {
    if (significance === null) return verdict === 'passed';
    if (significance === 'skipped-itself') return suite?.skips_fail !== true;
    return significance !== 'unexpected-pass';
}

/** Labels of tests for which a mark decided. */
export const LABELS: Record<Significance, string> = {
    expected: 'expected',
    quarantined: 'quarantined',
    'unexpected-pass': 'unexpected pass',
    'skipped-itself': '',
};

/** The address of an issue if it is a web page; other text is never a link. */
export function issueAddress(issue: string): string | null {
    if (!/^https?:\/\//i.test(issue) || !URL.canParse(issue)) return null;
    const { protocol, href } = new URL(issue);
    return protocol === 'http:' || protocol === 'https:' ? href : null;
}
