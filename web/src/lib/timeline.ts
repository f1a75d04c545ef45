// The timeline of a run: lanes with bars and marks,
// independent of drawing.

import type { AttemptRow, Fixture, Hook } from './api-types';
import { TEST_STATES } from './event';
import { marks, spans, type Mark } from './record/fixture';
import type { RunRecord } from './record/record';
import type { Shown } from './route';

/** The states of bars: of tests, fixtures, hooks and faults. Each has a colour, `--bar-…`. */
export const BAR_STATES = [
    ...TEST_STATES,
    'starting',
    'ready',
    'stopping',
    'hook',
    'hook-failed',
    'fault',
] as const;
export type BarState = (typeof BAR_STATES)[number];

export interface Bar {
    from: number;
    /** `null` while it lasts. */
    to: number | null;
    state: BarState;
    label: string;
    /** The target of a click. */
    target: Exclude<Shown, { what: 'overview' }>;
}

export interface Lane {
    kind: 'suite' | 'fixture' | 'hook' | 'fault';
    id: number;
    name: string;
    /** A suite whose tests overlap has several lanes, from 0. */
    row: number;
    bars: Bar[];
    marks: Mark[];
}

/** The lanes of a run: for each suite its tests, its faults, its fixtures, its hooks. */
export function lanes(record: RunRecord): Lane[] {
    const bars = record.suites.map(() => [] as Bar[]);
    const faults = record.suites.map(() => [] as Bar[]);
    for (const test of record.tests) {
        for (const attempt of test.attempts) {
            const { started, finished, verdict, number } = attempt;
            bars[test.suite]?.push({
                from: started,
                to: finished ?? null,
                state: verdict ?? (record.isOver ? 'interrupted' : 'running'),
                label: test.attempts.length > 1 ? `${test.name} (${number})` : test.name,
                target: { what: 'test', id: test.id, attempt: number },
            });
            faults[test.suite]?.push(...faultBars(test.id, attempt));
        }
    }
    return record.suites.flatMap((suite) => [
        ...apart(bars[suite.id] ?? []).map((each, row) => lane('suite', suite, each, { row })),
        ...apart(faults[suite.id] ?? [])
            .filter((each) => each.length > 0)
            .map((each, row) => lane('fault', { id: suite.id, name: 'faults' }, each, { row })),
        ...record
            .fixturesOf(suite)
            .map((each) => lane('fixture', each, fixtureBars(each), { marks: marks(each) })),
        ...record
            .hooksOf(suite)
            .filter((hook) => hook.runs.length > 0)
            .map((hook) => lane('hook', hook, hookBars(hook))),
    ]);
}

function lane(
    kind: Lane['kind'],
    { id, name }: Pick<Lane, 'id' | 'name'>,
    bars: Bar[],
    more: Partial<Lane> = {},
): Lane {
    return { kind, id, name, row: 0, bars, marks: [], ...more };
}

function fixtureBars(fixture: Fixture): Bar[] {
    return spans(fixture).map((span) => ({
        ...span,
        label: `${fixture.name}: ${span.state}`,
        target: { what: 'fixture', id: fixture.id },
    }));
}

function hookBars({ id, name, runs }: Hook): Bar[] {
    return runs.map(({ started, finished, problem, trigger, reason }) => ({
        from: started,
        to: finished ?? null,
        state: problem === undefined ? 'hook' : 'hook-failed',
        label: `${name} on ${trigger}: ${reason}`,
        target: { what: 'hook', id },
    }));
}

/** The faults of an attempt. One that was not removed ends with it; a kill lasts for a moment. */
function faultBars(test: number, attempt: AttemptRow): Bar[] {
    return (attempt.faults ?? []).map(({ name, kind, effect, injected, removed }): Bar => ({
        from: injected,
        to: kind === 'kill' ? injected : (removed ?? attempt.finished ?? null),
        state: 'fault',
        label: `${name}: ${effect}`,
        target: { what: 'test', id: test, attempt: attempt.number },
    }));
}

/** Distributes bars to rows without overlaps: each to the first free row. */
function apart(bars: Bar[]): Bar[][] {
    const rows: { bars: Bar[]; end: number }[] = [{ bars: [], end: 0 }];
    for (const bar of bars.sort((a, b) => a.from - b.from)) {
        const end = bar.to ?? Infinity;
        const free = rows.find((row) => row.end <= bar.from);
        if (free === undefined) {
            rows.push({ bars: [bar], end });
        } else {
            free.bars.push(bar);
            free.end = end;
        }
    }
    return rows.map((row) => row.bars);
}

/** A part of the run's time, in microseconds. */
export interface View {
    from: number;
    to: number;
}

const LEAST_US = 1000;

/** Zooms by a factor; the moment `at` stays where it is. */
export function zoom(view: View, factor: number, at: number, end: number): View {
    const width = Math.min(Math.max((view.to - view.from) * factor, LEAST_US), end);
    const share = (at - view.from) / (view.to - view.from);
    return clamp({ from: at - share * width, to: at - share * width + width }, end);
}

/** Moves by a share of the visible range. */
export function pan(view: View, share: number, end: number): View {
    const by = (view.to - view.from) * share;
    return clamp({ from: view.from + by, to: view.to + by }, end);
}

function clamp({ from, to }: View, end: number): View {
    const width = to - from;
    const start = Math.min(Math.max(0, from), Math.max(0, end - width));
    return { from: start, to: start + width };
}

/** Steps of an axis in seconds: 1, 2 and 5 times a power of ten below a minute. */
const STEPS = [
    ...[0.001, 0.01, 0.1, 1, 10].flatMap((power) => [power, 2 * power, 5 * power]),
    ...[1, 2, 5, 10, 30, 60, 120, 360].map((minutes) => minutes * 60),
];

/** Round moments for an axis, not more than `most` of them. */
export function ticks({ from, to }: View, most: number): { at: number; label: string }[] {
    const wanted = (to - from) / 1e6 / Math.max(1, most);
    const step = STEPS.find((each) => each >= wanted) ?? 86_400;
    const first = Math.ceil(from / 1e6 / step);
    const last = Math.floor(to / 1e6 / step);
    return Array.from({ length: Math.max(0, last - first + 1) }, (_, index) => {
        const at = (first + index) * step;
        return { at: at * 1e6, label: tickLabel(at, step) };
    });
}

function tickLabel(seconds: number, step: number): string {
    if (step >= 60) {
        const minutes = Math.round(seconds / 60);
        return minutes < 60
            ? `${minutes} min`
            : `${Math.floor(minutes / 60)} h ${String(minutes % 60).padStart(2, '0')}`;
    }
    if (step >= 1) return `${Math.round(seconds)} s`;
    if (step >= 0.001 && seconds < 1) return `${Math.round(seconds * 1000)} ms`;
    return `${Number(seconds.toFixed(3))} s`;
}

/** The bar at a moment, in a lane with sorted bars. */
export function barAt(lane: Lane, at: number, slack: number, now: number): Bar | null {
    let best: Bar | null = null;
    let distance = slack;
    for (const bar of lane.bars) {
        if (bar.from - slack > at) break;
        const to = bar.to ?? now;
        const away = at < bar.from ? bar.from - at : at > to ? at - to : 0;
        if (away <= distance) {
            best = bar;
            distance = away;
        }
    }
    return best;
}
