import { expect, test } from 'vitest';
import type { CampaignMap, CampaignReport } from '../generated/api';
import {
    HEIGHT,
    drawProgress,
    episodeHref,
    intervalText,
    mapOf,
    mapped,
    parametersText,
    rankingOrder,
    valueName,
} from '../lib/campaign';
import { campaignOf, parseRoute } from '../lib/route';

const rate = (value: number) => ({ value, low: value - 0.1, high: Math.min(1, value + 0.1) });
const cell = (values: string, passed: number) => ({
    values,
    episodes: 10,
    passed,
    rate: rate(passed / 10),
});
const maps: CampaignMap[] = [
    {
        x: 'payload',
        y: 'surface',
        rows: [
            { values: 'steel', cells: [cell('0 to 1', 1), cell('1 to 2', 2)] },
            { values: 'wood', cells: [cell('0 to 1', 3), cell('1 to 2', 4)] },
        ],
    },
];

test('a map is turned if the other parameter is that of the columns', () => {
    expect(mapped(maps)).toEqual(['payload', 'surface']);
    const numbers = (x: string, y: string) => {
        const map = mapOf(maps, x, y);
        return map && [map.columns, map.rows.map((row) => row.cells.map(({ passed }) => passed))];
    };
    expect(numbers('payload', 'surface')).toEqual([
        ['0 to 1', '1 to 2'],
        [
            [1, 2],
            [3, 4],
        ],
    ]);
    expect(numbers('surface', 'payload')).toEqual([
        ['steel', 'wood'],
        [
            [1, 3],
            [2, 4],
        ],
    ]);
    expect(numbers('payload', 'payload')).toBeNull();
    expect(numbers('payload', 'other')).toBeNull();
});

test('the progress is inside of the plot', () => {
    const progress = [10, 20, 40].map((episodes) => ({ episodes, rate: rate(episodes / 40) }));
    const campaign = { progress, claim: 0.9 } as CampaignReport;
    const drawing = drawProgress(campaign, 300);
    const points = `${drawing.line} ${drawing.band}`
        .split(' ')
        .map((it) => it.split(',').map(Number));
    expect(points).toHaveLength(9);
    for (const [x = NaN, y = NaN] of points) {
        expect(x).toBeGreaterThan(drawing.left);
        expect(x).toBeLessThanOrEqual(drawing.right);
        expect(y).toBeGreaterThanOrEqual(0);
        expect(y).toBeLessThanOrEqual(HEIGHT);
    }
    expect(drawing.claim).toBeGreaterThan(0);
    expect(drawProgress({ progress: [], claim: 0.9 } as unknown as CampaignReport, 0).line).toBe(
        '',
    );
    expect(intervalText(rate(0.5))).toBe('50.0 % (40.0 % to 60.0 %)');
});

test('an episode has the address of its run, and that leads to the campaign', () => {
    const run = 'campaigns/grasp 1/workers/2/2026';
    const place = parseRoute(episodeHref({ run, test: 3, attempt: 7 }));
    expect(place).toEqual({ at: 'run', run, show: { what: 'test', id: 3, attempt: 7 } });
    const batched = episodeHref({ run, test: 0, attempt: 1, case: 17 });
    expect(batched).toMatch(/\/tests\/0\?attempt=1&case=17$/);
    const part = { what: 'test', id: 0, attempt: 1, case: 17 };
    expect(parseRoute(batched)).toEqual({ at: 'run', run, show: part });
    const overview = parseRoute(episodeHref({ run }));
    expect(overview).toEqual({ at: 'run', run, show: { what: 'overview' } });
    expect(campaignOf(run)).toBe('grasp 1');
    expect(campaignOf('2026')).toBeUndefined();
});

test('a case is one of an attempt', () => {
    const shown = (query: string) => {
        const route = parseRoute(`#/runs/2026/tests/3?${query}`);
        return route.at === 'run' ? route.show : route;
    };
    const test = { what: 'test', id: 3 };
    expect(shown('attempt=2&case=17')).toEqual({ ...test, attempt: 2, case: 17 });
    expect(shown('case=17')).toEqual({ ...test, attempt: null });
    for (const bad of ['0', '-1', '1.5', 'x', ''])
        expect(shown(`attempt=2&case=${bad}`)).toEqual({ ...test, attempt: 2 });
});

test('a ranking says what it is ordered by', () => {
    const episode = { episode: 1, value: 1, parameters: {}, run: { run: '2026' } };
    const ranking = {
        by: 'Carry error',
        unit: 'rad',
        higher_is_worse: false,
        worst: [{ ...episode, outcome: 'failed' }],
        best: [{ ...episode, outcome: 'passed' }],
    };
    expect(valueName(ranking)).toBe('Carry error (rad)');
    expect(valueName({ by: 'Carry error', unit: '' })).toBe('Carry error');
    expect(rankingOrder(ranking)).toContain('then lower values, which failed episodes have');
    expect(rankingOrder({ ...ranking, worst: ranking.best })).toMatch(/then lower values\.$/);
    const duration = { ...ranking, by: 'duration', higher_is_worse: true };
    expect(rankingOrder(duration)).toMatch(/then higher values\.$/);
    expect(parametersText({ payload: '1.2', surface: 'wood' })).toBe('payload=1.2 surface=wood');
});
