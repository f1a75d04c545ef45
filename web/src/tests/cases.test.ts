import { readFileSync } from 'node:fs';
import { describe, expect, test } from 'vitest';
import type { Case } from '../lib/api-types';
import type { Event, Verdict } from '../lib/event';
import {
    isGreenVerdict,
    isRerunAsFailed,
    issueAddress,
    LABELS,
    significanceOf,
} from '../lib/known-failure';
import { CaseList } from '../lib/record/cases';
import { rows } from '../lib/tree';
import { recordOf, stream } from './streams';

let seq = 0;

function started(id: number, name: string, parent?: number): Event {
    const event = { type: 'case-started', seq: seq++, at: id * 10, test: 0, case: id, name };
    return { ...event, ...(parent === undefined ? {} : { parent }) } as Event;
}

function finished(id: number, at: number, verdict: Verdict, reason?: string): Event {
    const event = { type: 'case-finished', seq: seq++, at, test: 0, case: id, verdict };
    return { ...event, ...(reason === undefined ? {} : { reason }) } as Event;
}

const planned = (...names: string[]) =>
    ({ type: 'cases-planned', seq: seq++, at: 0, test: 0, names }) as Event;

function listOf(events: Event[]): CaseList {
    const list = new CaseList();
    for (const event of events) list.apply(event);
    return list;
}

/** Each row as its indented name and verdict. */
const shown = (list: CaseList, fits?: (entry: Case) => boolean) =>
    list
        .rows(fits)
        .map(({ entry, depth }) => `${'  '.repeat(depth)}${entry.name} ${entry.verdict ?? '…'}`);

/** `Arm` and `Legs` overlap, as on two threads. */
const NESTED = [
    planned('Arm', 'Legs', 'Head'),
    started(1, 'Arm'),
    started(2, 'Legs'),
    started(3, 'Home', 1),
    started(4, 'Walk', 2),
    finished(3, 35, 'passed'),
    started(5, 'Wave', 1),
    finished(5, 90, 'failed', 'stuck'),
];

describe('the cases of an attempt', () => {
    test('know which episode they are, and what was reported about it', () => {
        const start = { ...started(1, '17'), episode: { id: 17, seed: 4711 } } as Event;
        const list = listOf([start]);
        expect(list.get(1)?.episode).toEqual({ id: 17, seed: 4711 });
        const end = { steps: 200, time_us: 4_000_000 };
        list.apply({ ...finished(1, 90, 'failed'), episode: end } as Event);
        expect(list.get(1)?.episode).toEqual({ id: 17, seed: 4711, ...end });
        expect(listOf(NESTED).get(1)).not.toHaveProperty('episode');
    });

    test('are a tree, also when they overlap', () => {
        const list = listOf(NESTED);
        expect(shown(list)).toEqual([
            'Arm …',
            '  Home passed',
            '  Wave failed',
            'Legs …',
            '  Walk …',
        ]);
        expect(list.get(5)).toMatchObject({ path: 'Arm/Wave', duration_us: 40, reason: 'stuck' });
        expect(list.notRun).toEqual(['Head']);
        expect(list.counts()).toEqual({ passed: 1, failed: 1 });
    });

    test('that their framework ran again count once', () => {
        const again = { ...started(3, 'Arm'), earlier_attempts: 1 } as Event;
        const list = listOf([
            planned('Arm'),
            started(1, 'Arm'),
            started(2, 'Home', 1),
            finished(2, 20, 'failed'),
            { ...finished(1, 30, 'failed'), rerun: true } as Event,
            again,
            finished(3, 50, 'passed'),
        ]);
        expect(list.counts()).toEqual({ passed: 1 });
        expect(shown(list)).toEqual(['Arm failed', '  Home failed', 'Arm passed']);
        const superseded = [1, 2, 3].filter((id) => list.get(id)?.superseded);
        expect(superseded).toEqual([1, 2]);
        expect(list.get(3)?.earlier_attempts).toBe(1);
    });

    test('that match are shown below the cases that contain them', () => {
        const list = listOf(NESTED);
        expect(shown(list, ({ verdict }) => verdict === 'failed')).toEqual([
            'Arm …',
            '  Wave failed',
        ]);
        expect(shown(list, () => false)).toEqual([]);
    });

    test('that were carried keep their durations', () => {
        const list = listOf([
            started(1, 'Home'),
            { ...finished(1, 20, 'passed'), duration_us: 700, carried: true } as Event,
            started(2, 'Wave'),
        ]);
        expect(list.get(1)).toMatchObject({ carried: true, duration_us: 700 });
        expect(list.get(2)).not.toHaveProperty('carried');
    });

    test('contain the cases whose messages they select', () => {
        const list = listOf([...NESTED, started(6, 'Left', 5)]);
        expect([...list.within(1)]).toEqual([1, 3, 5, 6]);
        expect([...list.within(4)]).toEqual([4]);
    });

    test('are the same from a page and the events that overlap it', () => {
        for (let cut = 0; cut <= NESTED.length; cut += 1) {
            const before = listOf(NESTED.slice(0, cut));
            const page = before.rows().map(({ entry }) => entry);
            const opened = new CaseList();
            opened.load(page, before.notRun);
            for (const event of NESTED) opened.apply(event);
            expect(shown(opened), `after ${cut} events`).toEqual(shown(listOf(NESTED)));
            expect(opened.notRun).toEqual(['Head']);
        }
    });

    test('stay finished when an older page arrives later', () => {
        const list = listOf(NESTED);
        list.load([{ case: 5, parent: 1, name: 'Wave', path: 'Arm/Wave', started: 50 }]);
        expect(list.get(5)?.verdict).toBe('failed');
    });

    test('nest 20 000 levels deep', () => {
        const deep = Array.from({ length: 20_000 }, (_, index) =>
            started(index + 1, 'x', index === 0 ? undefined : index),
        );
        // Paths are long; rows need none.
        const list = new CaseList();
        list.load(
            deep.flatMap((event) =>
                event.type === 'case-started'
                    ? [{ ...event, path: 'x', started: 0, parent: event.parent ?? 0 } as Case]
                    : [],
            ),
        );
        expect(list.rows().at(-1)?.depth).toBe(19_999);
    });
});

describe('known failures', () => {
    test('are not rerun with the failed tests', () => {
        const tests = recordOf(stream('known-failures')).tests;
        const rerun = tests.filter(isRerunAsFailed);
        expect(rerun.length).toBeGreaterThan(0);
        expect(rerun.every(({ green }) => green === false)).toBe(true);
        const verdicts = new Set(rerun.map(({ verdict }) => verdict));
        expect(verdicts).toContain('passed');
        expect(verdicts).not.toContain('interrupted');
        const isExpected = ({ significance }: { significance?: string }) =>
            significance === 'expected' || significance === 'quarantined';
        expect(tests.some(isExpected)).toBe(true);
        expect(rerun.some(isExpected)).toBe(false);
    });

    const known = { verdicts: ['failed' as const] };
    test.each([
        [undefined, 'failed', null, false],
        [undefined, 'skipped', 'skipped-itself', true],
        [known, 'failed', 'expected', true],
        [known, 'passed', 'unexpected-pass', false],
        [known, 'crashed', null, false],
        [{ ...known, quarantined: true }, 'failed', 'quarantined', true],
        [{ ...known, quarantined: true }, 'passed', 'quarantined', true],
        [{ ...known, quarantined: true }, 'crashed', null, false],
        [{ ...known, expired: true }, 'failed', null, false],
        [{ ...known, expired: true }, 'passed', null, true],
    ] as const)('%j, %s: %s', (expected, verdict, significance, isGreen) => {
        const mark =
            expected === undefined
                ? {}
                : { expected: { ...expected, verdicts: [...expected.verdicts] } };
        const found = significanceOf(mark, verdict, true);
        expect(found).toBe(significance);
        expect(isGreenVerdict(verdict, found, {})).toBe(isGreen);
    });

    test('a skip is red if skips fail', () => {
        expect(isGreenVerdict('skipped', 'skipped-itself', { skips_fail: true })).toBe(false);
        expect(significanceOf({}, 'skipped', false)).toBe(null);
    });

    test.each([
        ['https://example.org/issues/7?a=1', 'https://example.org/issues/7?a=1'],
        ['HTTP://example.org', 'http://example.org/'],
        ['javascript:alert(1)', null],
        [' javascript:alert(1)', null],
        ['java\nscript:alert(1)', null],
        ['data:text/html,<script>alert(1)</script>', null],
        ['https:evil', null],
        ['//example.org', null],
        ['ARM-17: the elbow sticks', null],
        ['https://', null],
    ])('the issue %j leads to %s', (issue, address) => {
        expect(issueAddress(issue)).toBe(address);
    });
});

test('tests are found by their mark, parameters and cases', () => {
    const record = recordOf(stream('verdicts'));
    const [first, second, third] = record.tests;
    if (first === undefined || second === undefined || third === undefined)
        throw new Error('the stream has tests');
    first.expected = { verdicts: ['failed'] };
    second.expected = { verdicts: ['failed'], quarantined: true };
    third.expected = { verdicts: ['failed'], expired: true };
    third.parameters = [{ name: 'joint', value: '0' }];
    const found = (filter: Partial<Parameters<typeof rows>[1]>) =>
        rows(record, { search: '', states: new Set(), ...filter }, new Set()).flatMap((row) =>
            row.kind === 'test' ? [row.test.id] : [],
        );
    expect(found({ states: new Set(['expected']) })).toEqual([first.id]);
    expect(found({ states: new Set(['quarantined']) })).toEqual([second.id]);
    expect(found({ search: 'JOINT=0' })).toEqual([third.id]);
    expect(found({ search: 'no-such-name', byCase: new Set([second.id]) })).toEqual([second.id]);
});

test('an attempt that was being stopped did not skip itself', () => {
    const record = recordOf(stream('verdicts').filter(({ type }) => type.endsWith('planned')));
    const [first, second] = record.tests;
    if (first === undefined || second === undefined) throw new Error('the stream has tests');
    for (const { id: test } of [first, second]) {
        const common = { at: 0, test };
        const skips: object[] = [
            { ...common, type: 'test-started', repetition: 1, attempt: 1 },
            ...(test === second.id ? [{ ...common, type: 'test-stopping' }] : []),
            { ...common, type: 'test-finished', verdict: 'skipped', phase: 'run' },
        ];
        for (const event of skips)
            record.apply({ ...event, seq: record.info.seq } as unknown as Event);
    }
    expect([first.significance, first.green]).toEqual(['skipped-itself', true]);
    expect([second.significance, second.green]).toEqual([undefined, false]);
});

/** How each verdict counts: the table that the other reports are checked against. */
function goldenRows() {
    const table = new URL('../../../crates/rtf-report/tests/golden/verdicts.txt', import.meta.url);
    const lines = readFileSync(table, 'utf8').split('\n');
    return lines
        .filter((line) => line !== '' && !line.startsWith('#'))
        .map((line) => line.split(/\s+/) as [name: string, exit: string, console: string]);
}

test.each(goldenRows())('%s exits with %s', (name, exit, console) => {
    const found = recordOf(stream('known-failures')).tests.find((each) => each.name === name);
    expect(found?.green).toBe(exit === '0');
    const label = found?.significance === undefined ? '' : LABELS[found.significance];
    if (console === 'expected' || console === 'quarantined') expect(label).toBe(console);
    else if (console === 'passed' && exit !== '0') expect(label).toBe('unexpected pass');
});
