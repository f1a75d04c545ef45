// The differences between two runs.

import type { Test } from './api-types';
import type { TestState } from './event';
import { fullName } from './progress';
import type { RunRecord } from './record/record';

/** In display order. */
export const CHANGE_NAMES = {
    broke: 'passed before, not now',
    other: 'not passed, another verdict',
    fixed: 'passes now',
    slower: 'slower',
    faster: 'faster',
    new: 'new',
    gone: 'gone',
    same: 'the same',
};

export type Change = keyof typeof CHANGE_NAMES;

export const CHANGES = Object.keys(CHANGE_NAMES) as Change[];

/** One test in both runs; `null` where it is missing. */
export interface Pair {
    name: string;
    old: Side | null;
    new: Side | null;
    change: Change;
}

export interface Side {
    test: Test;
    state: TestState;
}

/** A test is slower or faster from 25 % and 100 ms on. */
const FACTOR = 1.25;
const LEAST_US = 100_000;

export function compareRuns(before: RunRecord, after: RunRecord): Pair[] {
    const [old, now] = [sides(before), sides(after)];
    const pairs = [...new Set([...now.keys(), ...old.keys()])].map((name): Pair => {
        const pair = { name, old: old.get(name) ?? null, new: now.get(name) ?? null };
        return { ...pair, change: changeOf(pair.old, pair.new) };
    });
    const rank = (pair: Pair) => CHANGES.indexOf(pair.change);
    return pairs.sort((a, b) => rank(a) - rank(b));
}

function sides(record: RunRecord): Map<string, Side> {
    const side = (test: Test) => ({ test, state: record.stateOf(test) });
    return new Map(record.tests.map((test) => [fullName(record, test), side(test)]));
}

function changeOf(old: Side | null, now: Side | null): Change {
    if (old === null) return 'new';
    if (now === null) return 'gone';
    if (old.state !== now.state) {
        if (old.state === 'passed') return 'broke';
        return now.state === 'passed' ? 'fixed' : 'other';
    }
    const [a, b] = [old.test.duration_us, now.test.duration_us];
    if (Math.abs(a - b) < LEAST_US) return 'same';
    if (b > a * FACTOR) return 'slower';
    return a > b * FACTOR ? 'faster' : 'same';
}
