// Which tests differ in two sets of runs: the rules of `rtf history compare`.

import type { TestComparison } from '../../generated/api';

/** A smaller relative difference of durations or numbers does not count. */
const THRESHOLD = 0.1;
/** How long a test must take for its duration to be compared, in seconds. */
const SHORTEST = 0.1;

export function differs(test: TestComparison): boolean {
    const { verdicts_a, verdicts_b, duration_a: a, duration_b: b } = test;
    if (test.last_a !== test.last_b || share(verdicts_a) !== share(verdicts_b)) return true;
    if (a != null && b != null && Math.max(a, b) >= SHORTEST && isLarge(a, b)) return true;
    return (test.numbers ?? []).some(
        ({ a, b, outside_a, outside_b }) =>
            a != null && b != null && (isLarge(a, b) || outside_a !== outside_b),
    );
}

function isLarge(a: number, b: number): boolean {
    return a !== b && Math.abs(b - a) >= THRESHOLD * Math.abs(a);
}

/** The share of passed results, in thousandths. */
function share(counts: Record<string, number>): number {
    const total = Object.values(counts).reduce((sum, number) => sum + number, 0);
    return Math.floor(((counts['passed'] ?? 0) * 1000) / Math.max(1, total));
}
