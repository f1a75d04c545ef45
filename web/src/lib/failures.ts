// Groups tests that did not pass by cause.

import type { Test } from './api-types';
import type { TestState } from './event';

export interface FailureGroup<T> {
    state: TestState;
    reason: string;
    tests: T[];
}

/** Numbers, addresses and times differ between failures with one cause. */
const VARYING = /0x[0-9a-f]+|[-+]?\d+(?:[.,:]\d+)*(?:e[-+]?\d+)?/gi;

/** Groups in the order of their first tests. */
export function groupFailures<T extends Pick<Test, 'reason'>>(
    tests: readonly T[],
    stateOf: (test: T) => TestState,
): FailureGroup<T>[] {
    const groups = new Map<string, FailureGroup<T>>();
    for (const test of tests) {
        const state = stateOf(test);
        const reason = test.reason ?? '';
        const key = `${state}\n${reason.replace(VARYING, '#')}`;
        const group = groups.get(key);
        if (group === undefined) groups.set(key, { state, reason, tests: [test] });
        else group.tests.push(test);
    }
    return [...groups.values()];
}
