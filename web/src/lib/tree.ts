// The rows of the list of suites and tests, filtered.

import type { Suite, Test } from './api-types';
import type { TestState } from './event';
import { markOf, type Mark } from './known-failure';
import type { RunRecord } from './record/record';

export type Row =
    | { kind: 'suite'; suite: Suite; isOpen: boolean; shown: number; tests: number }
    | { kind: 'test'; test: Test; state: TestState; position: number; siblings: number };

export interface Filter {
    /** Words that `suite/test`, its parameters or the path of a case must contain; `tag:slow` requires a tag. */
    search: string;
    /** Accepted states and known failures; none means all. */
    states: ReadonlySet<TestFilter>;
    /** Tests with a case that matches the search. */
    byCase?: ReadonlySet<number>;
}

/** A state, or how a test is marked. */
export type TestFilter = TestState | Mark;

/** A filter, prepared for many tests. */
export function compile(filter: Filter): (suite: string, test: Test, state: TestState) => boolean {
    const words = filter.search.toLowerCase().split(/\s+/).filter(Boolean);
    const tags = words.filter((word) => word.startsWith('tag:')).map((word) => word.slice(4));
    const names = words.filter((word) => !word.startsWith('tag:'));
    return (suite, test, state) => {
        if (filter.states.size > 0 && !filter.states.has(state)) {
            const mark = markOf(test);
            if (mark === null || !filter.states.has(mark)) return false;
        }
        if (!tags.every((tag) => test.tags?.some((each) => each.toLowerCase() === tag)))
            return false;
        if (names.length === 0) return true;
        const parameters = test.parameters?.map(({ name, value }) => ` ${name}=${value}`) ?? [];
        const name = `${suite}/${test.name}${parameters.join('')}`.toLowerCase();
        return names.every((word) => name.includes(word)) || filter.byCase?.has(test.id) === true;
    };
}

/** All rows, in the order of the plan. Suites without matches are left out. */
export function rows(record: RunRecord, filter: Filter, closed: ReadonlySet<number>): Row[] {
    const fits = compile(filter);
    const isFiltered = filter.search.trim() !== '' || filter.states.size > 0;
    const groups = record.suites.map((suite) => ({
        suite,
        tests: [] as { test: Test; state: TestState }[],
        all: 0,
    }));
    for (const test of record.tests) {
        const group = groups[test.suite];
        if (group === undefined) continue;
        group.all += 1;
        const state = record.stateOf(test);
        if (fits(group.suite.name, test, state)) group.tests.push({ test, state });
    }
    const result: Row[] = [];
    for (const { suite, tests, all } of groups) {
        if (tests.length === 0 && isFiltered) continue;
        const isOpen = !closed.has(suite.id);
        result.push({ kind: 'suite', suite, isOpen, shown: tests.length, tests: all });
        if (!isOpen) continue;
        tests.forEach(({ test, state }, index) =>
            result.push({ kind: 'test', test, state, position: index + 1, siblings: tests.length }),
        );
    }
    return result;
}

/** A row's id in the page: `t17`, `s0`. */
export function rowKey(row: Row): string {
    return row.kind === 'suite' ? `s${row.suite.id}` : `t${row.test.id}`;
}
