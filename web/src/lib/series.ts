// Measurements of one name as a series.

import type { MeasurementEntry, Signal } from './api-types';
import { isWithin } from './record/detail';

export interface Point {
    /** Microseconds since the attempt began, or the number of an attempt. */
    at: number;
    value: number | null;
}

export interface Series {
    key: string;
    name: string;
    unit: string;
    /** The last reported limits. */
    low: number | null;
    high: number | null;
    /** Whether the limits are learned from earlier runs. */
    learned: boolean;
    points: Point[];
    /** The last value; `null` when it is not a finite number. */
    last: number | null;
    least: number;
    most: number;
    mean: number;
    violations: number;
}

/** The name of a series with its unit. */
export function titleOf({ name, unit }: Series): string {
    return unit === '' ? name : `${name} (${unit})`;
}

/**
 * Entries of the same name and unit, in the order of the names' first entries; their
 * times are counted from `zero` on.
 */
export function series(entries: readonly MeasurementEntry[], zero = 0): Series[] {
    const found = new Map<string, Series>();
    const finite = new Map<string, number>();
    for (const { at, measurement } of entries) {
        const {
            name,
            unit = '',
            low = null,
            high = null,
            value = null,
            learned = false,
        } = measurement;
        const key = `${name}\n${unit}`;
        let one = found.get(key);
        if (one === undefined) {
            const fresh = { points: [], last: null, least: Infinity, most: -Infinity, mean: NaN };
            one = { key, name, unit, low, high, learned, ...fresh, violations: 0 };
            found.set(key, one);
        }
        one.low = low;
        one.high = high;
        one.learned = learned;
        one.points.push({ at: at - zero, value });
        one.last = value;
        if (!isWithin(measurement)) one.violations += 1;
        if (value === null) continue;
        one.least = Math.min(one.least, value);
        one.most = Math.max(one.most, value);
        const taken = (finite.get(key) ?? 0) + 1;
        finite.set(key, taken);
        // A sum of very large values would overflow.
        const mean = taken === 1 ? value : one.mean;
        one.mean = mean + (value / taken - mean / taken);
    }
    return [...found.values()];
}

/**
 * The scale of a drawing of values and limits; `null` without limits. With
 * one limit, it also reaches to zero, or as far as the limit is from zero: the same
 * limit has the same scale as long as the values fit, and different values have different places.
 */
export function scaleOf(one: Series): { from: number; to: number } | null {
    const { low, high, least, most } = one;
    if (low === null && high === null) return null;
    if (low === null || high === null) return oneSided((low ?? high)!, high !== null, one);
    const known = [low, high, least, most].filter(
        (each): each is number => each !== null && Number.isFinite(each),
    );
    const [from, to] = [Math.min(...known), Math.max(...known)];
    const by = (to - from) * 0.15 || Math.abs(to) * 0.2 || 1;
    const scale = { from: from - by, to: to + by };
    // Values near the largest number leave no room.
    return Number.isFinite(scale.to - scale.from) ? scale : null;
}

function oneSided(limit: number, isUpper: boolean, { least, most }: Series) {
    const size = Math.abs(limit) || Math.max(Math.abs(least), Math.abs(most)) || 1;
    const by = Number.isFinite(size) ? size : 1;
    const [inner, outer] = isUpper ? [limit - by, limit + by / 4] : [limit - by / 4, limit + by];
    const finite = [least, most].filter(Number.isFinite);
    const scale = {
        from: Math.min(inner, outer, ...finite),
        to: Math.max(inner, outer, ...finite),
    };
    return Number.isFinite(scale.to - scale.from) ? scale : null;
}

/** A signal as a series for a plot: its curve, `zero` microseconds after the attempt's start. */
export function ofSignal(signal: Signal, zero = 0): Series {
    const { name, unit, low = null, high = null, last = null } = signal;
    const { times, values, outside: violations, mean = NaN } = signal;
    const points = times.map((time, index) => ({
        at: time * 1e6 + zero,
        value: values[index] ?? null,
    }));
    // A test may report its times in any order; a plot needs ascending times.
    points.sort((a, b) => a.at - b.at);
    const [least, most] = [signal.min ?? Infinity, signal.max ?? -Infinity];
    const about = { key: name, name, unit, low, high, learned: false };
    return { ...about, points, last, least, most, mean, violations };
}
