import { describe, expect, test } from 'vitest';
import { compareRuns } from '../lib/compare';
import { groupFailures } from '../lib/failures';
import { axisLabels, clock, count, duration, grouped, limits, number } from '../lib/format';
import { OutputRows } from '../lib/output';
import { phaseTimes, setUpAfter } from '../lib/phases';
import { padded } from '../lib/plot';
import { estimate, historyOf } from '../lib/progress';
import { hrefOf, parseRoute, type Route } from '../lib/route';
import { ofSignal, scaleOf, series } from '../lib/series';
import { barAt, lanes, pan, ticks, zoom } from '../lib/timeline';
import { rows } from '../lib/tree';
import { recordOf, stream } from './streams';

const NO_FILTER = { search: '', states: new Set<never>() };

describe('numbers and times', () => {
    test.each([
        [duration(830), '0.8 ms'],
        [duration(999_400), '999 ms'],
        [duration(12_345_000), '12.3 s'],
        [duration(245_000_000), '4 min 05 s'],
        [clock(7384), '2 h 03 min'],
        [number(1e-9), '1e-9'],
        [number(0.1), '0.1'],
        [limits(95, 105), '95 … 105'],
        [limits(null, 0), '≤ 0'],
        [count(1, 'test'), '1 test'],
        [grouped(1234567), '1\u202f234\u202f567'],
    ])('%s', (shown, expected) => expect(shown).toBe(expected));
});

describe('what is drawn', () => {
    test.each([
        [[1.3405, 1.341, 1.3415], 0.0005, ['1.3405', '1.3410', '1.3415']],
        [[0, 0.25, 0.5], 0.25, ['0.00', '0.25', '0.50']],
        [[-0.2, 0, 0.2], 0.2, ['-0.2', '0.0', '0.2']],
        [[0, 10, 20], 10, ['0', '10', '20']],
        [[1e9, 1e9 + 1], 1, ['1000000000', '1000000001']],
        [[1e308, 1.5e308], 5e307, ['1e+308', '1.5e+308']],
    ])('labels of an axis tell its values apart: %j', (values, step, labels) => {
        expect(axisLabels(values, step)).toEqual(labels);
    });

    const of = (value: number, low: number | null, high: number | null) =>
        series([{ seq: 1, at: 0, within: true, measurement: { name: 'x', value, low, high } }])[0]!;
    const place = (value: number, low: number | null, high: number | null) => {
        const { from, to } = scaleOf(of(value, low, high))!;
        return (value - from) / (to - from);
    };

    test('different values have different places against one limit', () => {
        expect(place(4.09, null, 5) - place(3.67, null, 5)).toBeGreaterThan(0.05);
        expect(place(7, 5, null) - place(6, 5, null)).toBeGreaterThan(0.05);
        expect(place(-3, null, 0)).toBeCloseTo(0);
        for (const value of [-1e308, -1, 0, 1e-9, 99])
            for (const limit of [-1e308, 0, 5, 1e308]) {
                const scale = scaleOf(of(value, limit, null));
                if (scale !== null) expect(place(value, limit, null)).toBeLessThanOrEqual(1);
            }
    });

    test('values near the end of their range have a mean, and leave the plot in order', () => {
        const entries = [1e308, -1e308, 1e308].map((value, index) => ({
            ...{ seq: index, at: index * 1e6, within: true },
            measurement: { name: 'x', value },
        }));
        const [one] = series(entries, 1e6);
        expect(Number.isFinite(one!.mean)).toBe(true);
        expect(one!.points.map(({ at }) => at)).toEqual([-1e6, 0, 1e6]);
        const [low, high] = padded(-Number.MAX_VALUE, Number.MAX_VALUE);
        expect(Number.isFinite(high - low)).toBe(true);
    });

    test('phases begin with the time that it took to load', () => {
        const phases = [
            { phase: 'setup' as const, at: 150 },
            { phase: 'run' as const, at: 200 },
        ];
        expect(phaseTimes(100, phases, 260)).toEqual([
            { name: 'load', took: 50 },
            { name: 'set-up', took: 50 },
            { name: 'run', took: 60 },
        ]);
        expect(setUpAfter(100, phases)).toBe(50);
    });
});

describe('tests that did not pass', () => {
    test('form one group if their causes differ only in numbers', () => {
        const tests = [
            { id: 1, reason: 'elbow is 1.75 rad at 0.3 s' },
            { id: 2, reason: 'no answer of /arm' },
            { id: 3, reason: 'elbow is -2e-3 rad at 12 s' },
            { id: 4, reason: 'elbow is lost' },
            { id: 5 },
        ];
        const groups = groupFailures(tests, ({ id }) => (id === 4 ? 'crashed' : 'failed'));
        expect(groups.map((group) => group.tests.map(({ id }) => id))).toEqual([
            [1, 3],
            [2],
            [4],
            [5],
        ]);
    });
});

describe('places in the page', () => {
    const routes: Route[] = [
        { at: 'home' },
        { at: 'runs', filter: {} },
        { at: 'runs', filter: { q: 'arm &?', result: 'red', since: '2026-11-21' } },
        { at: 'compare', old: 'a/b', new: 'c?d' },
        { at: 'run', run: '2026 %', show: { what: 'overview' } },
        { at: 'run', run: 'r', show: { what: 'test', id: 3, attempt: 2 } },
        { at: 'run', run: 'r', show: { what: 'test', id: 0, attempt: null } },
        { at: 'run', run: 'r', show: { what: 'fixture', id: 1 } },
        { at: 'run', run: 'r', show: { what: 'hook', id: 1 } },
    ];
    test.each(routes)('$at', (route) => expect(parseRoute(hrefOf(route))).toEqual(route));

    test('an invalid filter is reported, and its valid parts apply', () => {
        const query = 'result=good&commit=xyz&until=2026-02-30&branch=main&colour=red&robot=';
        expect(parseRoute(`#/runs?${query}`)).toEqual({
            at: 'runs',
            filter: { branch: 'main' },
            problems: [
                '“good” is no result: running, green, red, interrupted, died, damaged',
                '“xyz” is no commit: 4 to 64 hexadecimal digits',
                '“2026-02-30” is no day: like 2026-11-21',
                'there is no filter “colour”',
            ],
        });
    });

    test('an invalid address opens the start page', () => {
        expect(parseRoute('#/%zz/x')).toEqual({ at: 'home' });
        expect(parseRoute('#/runs/r/tests/-1')).toMatchObject({ show: { what: 'overview' } });
    });
});

describe('the list of tests', () => {
    const record = recordOf(stream('verdicts'));
    const found = (search: string, states: Parameters<typeof rows>[1]['states'] = new Set()) =>
        rows(record, { search, states }, new Set()).flatMap((row) =>
            row.kind === 'test' ? [row.test.name] : [],
        );

    test('all of it', () => expect(rows(record, NO_FILTER, new Set())).toHaveLength(10));
    test('by words of suite and name', () => {
        const name = record.tests[0]?.name ?? '';
        expect(found(`ARM/ ${name.slice(1, 4).toLowerCase()}`)).toContain(name);
        expect(found('no such test')).toEqual([]);
    });
    test('by verdict', () => {
        expect(found('', new Set(['crashed']))).toHaveLength(1);
    });
    test('a closed suite has no rows below it', () => {
        const all = rows(record, NO_FILTER, new Set(record.suites.map(({ id }) => id)));
        expect(all.every((row) => row.kind === 'suite')).toBe(true);
    });
});

describe('the timeline', () => {
    const record = recordOf(stream('collapse-restart'));
    const all = lanes(record);

    test('has the suite and its fixture', () => {
        expect(all.map(({ kind, bars }) => [kind, bars.length])).toEqual([
            ['suite', 3],
            ['fixture', 7],
        ]);
    });
    test('overlapping tests have separate rows', () => {
        const suites = lanes(recordOf(stream('parallel'))).filter(({ kind }) => kind === 'suite');
        expect(suites.map(({ row, bars }) => [row, bars.map(({ label }) => label)])).toEqual([
            [0, ['EncoderTest (1)', 'EncoderTest (2)', 'EncoderTest (3)']],
            [1, ['LimitTest', 'MoveTest', 'GripTest']],
        ]);
        for (const { bars } of suites) {
            const ends = bars.map(({ to }) => to ?? Infinity);
            expect(bars.slice(1).every(({ from }, index) => from >= ends[index]!)).toBe(true);
        }
    });
    test('a moment leads to its test', () => {
        const suite = all[0]!;
        expect(barAt(suite, 1_770_000, 0, 0)?.target).toEqual({ what: 'test', id: 0, attempt: 2 });
        expect(barAt(suite, 10, 0, 0)).toBeNull();
    });
    test('zoom keeps the moment, and stays inside the run', () => {
        const view = zoom({ from: 0, to: 1000_000 }, 0.5, 250_000, 1000_000);
        expect(view).toEqual({ from: 125_000, to: 625_000 });
        expect(pan(view, -10, 1000_000)).toEqual({ from: 0, to: 500_000 });
        expect(zoom(view, 100, 0, 1000_000)).toEqual({ from: 0, to: 1000_000 });
    });
    test('ticks are round', () => {
        expect(ticks({ from: 0, to: 10e6 }, 5).map(({ label }) => label)).toEqual([
            '0 s',
            '2 s',
            '4 s',
            '6 s',
            '8 s',
            '10 s',
        ]);
    });
});

test('the remaining time is estimated from the last run', () => {
    const events = stream('measured');
    const history = historyOf(recordOf(events));
    const now = recordOf(events.slice(0, 12));
    expect(estimate(now, 14_040, history)).toEqual({
        seconds: expect.closeTo(0.014),
        basis: 'last run',
    });
    expect(estimate(now, 14_040, new Map())).toEqual({
        seconds: expect.closeTo(0.014),
        basis: 'this run',
    });
    expect(estimate(recordOf(events.slice(0, 4)), 0, new Map())).toBeNull();
});

test('two runs are compared by the names of their tests', () => {
    const before = recordOf(stream('verdicts'));
    const after = recordOf(stream('collapse-restart'));
    const pairs = compareRuns(before, after);
    expect(pairs).toHaveLength(
        new Set([...before.tests, ...after.tests].map(({ name }) => name)).size,
    );
    expect(compareRuns(before, before).every(({ change }) => change === 'same')).toBe(true);
    expect(compareRuns(after, recordOf(stream('no-tests'))).map(({ change }) => change)).toEqual([
        'gone',
        'gone',
    ]);
});

describe('output', () => {
    const row = (text: string, stream: 'stdout' | 'stderr' = 'stdout') => ({
        seq: 0,
        at: 0,
        stream,
        text,
    });
    const shown = (rows: OutputRows) =>
        rows.rows.map(
            ({ pieces, isContinued }) =>
                (isContinued ? '+' : '') + pieces.map(({ text }) => text).join(''),
        );

    test('lines are rows, wherever their pieces were cut', () => {
        const rows = new OutputRows(80);
        for (const text of ['one\ntw', 'o\n\nthree']) rows.add(row(text));
        expect(shown(rows)).toEqual(['one', 'two', '', 'three']);
    });
    test('long lines continue in the next row, and no character is split', () => {
        const rows = new OutputRows(4);
        rows.add(row('abc🤖defgh'));
        expect(shown(rows)).toEqual(['abc', '+🤖de', '+fgh']);
    });
    test('a line of a megabyte', () => {
        const rows = new OutputRows(100);
        rows.add(row('x'.repeat(1_000_000)));
        expect(rows.rows).toHaveLength(10_000);
    });
    test('streams do not share a row, and omitted bytes are reported', () => {
        const rows = new OutputRows(80);
        rows.add(row('out'));
        rows.add({ ...row('err\n', 'stderr'), omitted_bytes: 123 });
        expect(shown(rows)).toEqual(['out', '… 123 bytes left out …', 'err']);
    });
});

test('a measurement near the largest number has no scale, and does not break', () => {
    const entries = stream('nasty').flatMap((event) =>
        event.type === 'measured'
            ? [{ seq: event.seq, at: event.at, measurement: event.measurement, within: false }]
            : [],
    );
    const [one] = series(entries);
    expect(one?.violations).toBe(1);
    expect(scaleOf({ ...one!, most: Number.MAX_VALUE, least: -Number.MAX_VALUE })).toBeNull();
});

test('a signal is drawn from left to right, in any order of its times', () => {
    const signal = { name: 'elbow', unit: 'rad', high: 1.5, count: 3, min: 0.25, max: 1.75 };
    const curve = { times: [0, 1, 0.5], values: [0.25, 1.75, 1] };
    const drawn = ofSignal({ ...signal, mean: 1, last: 1, outside: 1, ...curve });
    expect(drawn.points).toEqual([
        { at: 0, value: 0.25 },
        { at: 500_000, value: 1 },
        { at: 1_000_000, value: 1.75 },
    ]);
    expect(drawn).toMatchObject({ low: null, high: 1.5, last: 1, violations: 1 });
});
