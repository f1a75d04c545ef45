import { describe, expect, test } from 'vitest';
import type {
    CampaignChange,
    CampaignSeries,
    HistoryChange,
    HistoryMatrix,
    RatePoint,
    TestSeries,
} from '../generated/api';
import { differs } from '../lib/history/differences';
import { HEAD, visible, CELL } from '../lib/history/draw-matrix';
import { describe as inWords, extended, withProblems } from '../lib/history/matrix';
import { formatQuery, historyHref, parseQuery, selectionOf } from '../lib/history/query';
import { HEIGHT, changesOf, drawRates, rateChangeText, rateText } from '../lib/history/rates';
import { changeText, seriesPlot } from '../lib/history/trends';
import { hrefOf, parseRoute } from '../lib/route';

const identity = { suite: 'arm', test: 'Sweep' };

describe('addresses', () => {
    test.each([
        '#/history',
        '#/history/flaky?branch=main',
        '#/history/test?test=arm%2F%3Cscript%3E%3A%3Acase+1&last=5',
        '#/history/compare?a=branch%3Amain&b=robot%3Aicub&since=30d',
    ])('%s', (hash) => expect(hrefOf(parseRoute(hash))).toBe(hash));

    test('unknown views and values are ignored', () => {
        const route = parseRoute('#/history/nonsense?colour=red&branch=%20&last=3');
        expect(route).toEqual({ at: 'history', view: 'matrix', query: { last: '3' } });
        expect(formatQuery(parseQuery('a=1'))).toBe('a=1');
        expect(selectionOf({ a: 'x', branch: 'main' })).toEqual({ branch: 'main' });
        expect(historyHref('slow')).toBe('#/history/slow');
    });
});

describe('the matrix', () => {
    const run = { id: '1', name: 'run-1', started: '2026-11-01T00:00:00Z', green: true };
    const page = (names: string[], next?: number): HistoryMatrix => ({
        runs: [run],
        tests: names.map((name) => ({ suite: 'arm', test: name, verdicts: 'p' })),
        robots: names,
        total: 3,
        ...(next === undefined ? {} : { next }),
    });

    test('grows by pages', () => {
        const first = extended(null, page(['b', 'a'], 2));
        expect(first.isPart).toBe(true);
        const whole = extended(first, page(['c']));
        expect(whole.rows.map(({ name }) => name)).toEqual(['arm/b', 'arm/a', 'arm/c']);
        expect(whole.robots).toEqual(['a', 'b', 'c']);
        expect(whole.isPart).toBe(false);
    });

    test('a skipped or interrupted test has no problem, a retried one has', () => {
        const rows = ['pp-si', 'pPp', 'pxp', 'ppf'].map((verdicts) => ({
            name: verdicts,
            suiteFile: '',
            verdicts,
        }));
        expect(withProblems(rows).map(({ name }) => name)).toEqual(['pPp', 'pxp', 'ppf']);
        expect([inWords('P'), inWords('x'), inWords('-')]).toEqual([
            'passed after a retry',
            'collapsed',
            'no result',
        ]);
    });

    test('only the cells in sight are drawn', () => {
        const frame = {
            width: 200 + CELL.width * 10,
            height: HEAD + CELL.height * 5,
            gutter: 200,
            scroll: { left: CELL.width * 990.5, top: CELL.height * 2 },
            cursor: null,
        };
        expect(visible(frame, 1000, 1000)).toEqual({ rows: [2, 7], columns: [990, 1000] });
        expect(visible(frame, 3, 995).rows).toEqual([2, 3]);
    });
});

describe('trends', () => {
    const point = (run: string, value?: number) => ({
        run,
        started: `2026-11-0${run}T00:00:00Z`,
        count: 1,
        high: 20,
        ...(value === undefined ? {} : { value }),
    });
    const series: TestSeries = {
        ...identity,
        kind: 'measurement',
        name: 'lag',
        unit: 'ms',
        points: [point('1', 10), point('2'), point('3', 14)],
    };
    const change: HistoryChange = {
        ...identity,
        series: { kind: 'measurement', name: 'lag', unit: 'ms' },
        run: '3',
        before: 10,
        after: 14,
        fraction: 0.4,
    };

    test('a plot has the limits, a gap for what is not finite, and its change points', () => {
        const others = [
            { ...change, series: { ...change.series!, unit: 's' } },
            { ...change, test: 'Grip' },
        ];
        const plot = seriesPlot(series, [change, ...others]);
        expect(plot.series.points.map(({ value }) => value)).toEqual([10, null, 14]);
        expect([plot.series.low, plot.series.high, plot.series.mean]).toEqual([null, 20, 12]);
        expect(plot.marks).toEqual([2]);
        expect(changeText(change, 'ms')).toBe('10 → 14 ms (+40 %)');
    });
});

test('tests differ by share of passes, duration or numbers', () => {
    const same = {
        ...identity,
        verdicts_a: { passed: 10 },
        verdicts_b: { passed: 2 },
        last_a: 'passed',
        last_b: 'passed',
        duration_a: 0.2,
        duration_b: 0.21,
    };
    expect(differs(same)).toBe(false);
    expect(differs({ ...same, verdicts_b: { passed: 1, failed: 1 } })).toBe(true);
    expect(differs({ ...same, duration_b: 0.4 })).toBe(true);
    expect(differs({ ...same, duration_a: 0.01, duration_b: 0.05 })).toBe(false);
    const lag = { kind: 'measurement' as const, name: 'lag', a: 1, outside_a: 0, outside_b: 0 };
    expect(differs({ ...same, numbers: [{ ...lag, b: 1.05 }] })).toBe(false);
    expect(differs({ ...same, numbers: [{ ...lag, b: 1.2 }] })).toBe(true);
});

describe('rates of campaigns', () => {
    const rate = (value: number, by: number) => ({ value, low: value - by, high: value + by });
    const point = (campaign: string, share: number): RatePoint => ({
        campaign,
        directory: campaign,
        started: '2026-11-01T00:00:00Z',
        passed: share * 100,
        failed: 100 - share * 100,
        without_result: 0,
        rate: rate(share, 0.02),
        claim: 0.9,
        verdict: share < 0.9 ? 'failed' : 'passed',
    });
    const none = { ...point('c', 0), rate: undefined } as unknown as RatePoint;
    const points = [point('a', 0.97), point('b', 0.95), none, point('d', 0.71)];
    const segment = (value: number) => ({
        campaigns: 1,
        passed: 1,
        failed: 1,
        rate: rate(value, 0),
    });
    const change = (campaign: string): CampaignChange => ({
        name: 'grasp',
        file: 'grasp.xml',
        campaign,
        directory: campaign,
        started: '2026-11-01T00:00:00Z',
        before: segment(0.96),
        after: segment(0.71),
        p_value: 1e-9,
    });

    test('are inside of the plot, with their claims', () => {
        const { marks, ticks, changes, bottom } = drawRates(points, [change('d')], 400);
        expect(marks.map(({ point }) => point.campaign)).toEqual(['a', 'b', 'd']);
        for (const { x, y, low, high, claim } of marks) {
            expect(x).toBeGreaterThan(48);
            expect(x).toBeLessThan(400);
            expect(high).toBeGreaterThanOrEqual(0);
            expect(high).toBeLessThan(y);
            expect(y).toBeLessThan(low);
            expect(low).toBeLessThanOrEqual(bottom);
            expect(claim).toBe(marks[0]?.claim);
        }
        expect(ticks[0]).toEqual({ y: bottom, text: '65 %' });
        expect(ticks.at(-1)?.text).toBe('100 %');
        expect(changes).toHaveLength(1);
        expect(changes[0]).toBeGreaterThan(marks[1]!.x);
        expect(changes[0]).toBeLessThan(marks[2]!.x);
        expect(drawRates([], [], 0).marks).toEqual([]);
        expect(bottom).toBeLessThan(HEIGHT);
    });

    test('in words', () => {
        expect(rateText(points[0]!.rate)).toBe('97.0 % (95.0 % to 99.0 %)');
        expect(rateText(undefined)).toBe('no result');
        expect(rateChangeText(change('d'))).toBe('96.0 % → 71.0 % (-25 %), p < 0.0001');
        const series = { name: 'grasp', file: 'grasp.xml', space: '', points } as CampaignSeries;
        const changes = [change('d'), change('b'), change('of another series')];
        expect(changesOf(series, changes).map(({ campaign }) => campaign)).toEqual(['b', 'd']);
    });
});
