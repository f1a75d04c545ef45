// Series of the history as plots over runs.

import type { HistoryChange, SeriesPoint, TestHistory, TestSeries } from '../../generated/api';
import { short } from '../format';
import { present } from '../present';
import type { Series } from '../series';
import { testName } from './query';

/** A plot over runs: run `at` of the series is the one with this index. */
export interface RunPlot {
    series: Series;
    /** The start of each run. */
    labels: string[];
    /** The runs of change points. */
    marks: number[];
    changes: HistoryChange[];
}

type Value = Pick<SeriesPoint, 'run' | 'started' | 'value'>;

function plotOf(
    values: readonly Value[],
    about: Pick<Series, 'key' | 'name' | 'unit' | 'low' | 'high' | 'violations'>,
    changes: HistoryChange[],
): RunPlot {
    const finite = values.flatMap(({ value }) => value ?? []);
    const points = values.map(({ value = null }, at) => ({ at, value }));
    const mean = finite.reduce((sum, value) => sum + value / finite.length, 0);
    const marks = changes.map(({ run }) => values.findIndex((value) => value.run === run));
    return {
        series: {
            ...about,
            learned: false,
            points,
            last: points.at(-1)?.value ?? null,
            least: Math.min(...finite),
            most: Math.max(...finite),
            mean: finite.length === 0 ? NaN : mean,
        },
        labels: values.map(({ started }) => started),
        marks: [...new Set(marks)].filter((index) => index >= 0),
        changes,
    };
}

/** A measurement or signal over runs. */
export function seriesPlot(one: TestSeries, changes: readonly HistoryChange[]): RunPlot {
    const { name, unit = '', kind } = one;
    const last = one.points.at(-1);
    const violations = one.points.reduce((sum, { outside = 0 }) => sum + outside, 0);
    const [low, high] = [last?.low ?? null, last?.high ?? null];
    const test = testName(one);
    const isThis = (change: HistoryChange) =>
        testName(change) === test &&
        (change.suite_file ?? '') === (one.suite_file ?? '') &&
        change.series?.name === name &&
        change.series.kind === kind &&
        (change.series.unit ?? '') === unit;
    const key = `${test}\n${kind}\n${name}\n${unit}`;
    return plotOf(one.points, { key, name, unit, low, high, violations }, changes.filter(isThis));
}

/** The durations of a test over runs. */
export function durationPlot(test: TestHistory, changes: readonly HistoryChange[]): RunPlot {
    const values = test.results.map(({ run, started, duration }) => ({
        run,
        started,
        ...present({ value: duration }),
    }));
    const about = { key: 'duration', name: 'duration', unit: 's', violations: 0 };
    const isThis = (change: HistoryChange) =>
        change.series === undefined && (change.suite_file ?? '') === (test.suite_file ?? '');
    return plotOf(values, { ...about, low: null, high: null }, changes.filter(isThis));
}

/** A change point in words: `12.1 → 14 ms (+16 %)`. */
export function changeText({ before, after, fraction }: HistoryChange, unit: string): string {
    const size = fraction == null ? '' : ` (${percent(fraction, true)})`;
    return `${short(before)} → ${short(after)}${unit === '' ? '' : ` ${unit}`}${size}`;
}

/** A rate in percent. */
export function percent(rate: number, isSigned = false): string {
    const text = `${(rate * 100).toFixed(Math.abs(rate) < 0.0995 ? 1 : 0)} %`;
    return isSigned && rate > 0 ? `+${text}` : text;
}
