// The data of a plot.

import uPlot from 'uplot';
import type { Series } from './series';

/**
 * The times and values of series; a single series includes its limits. Times are multiplied by
 * `factor`.
 */
export function alignedData(series: readonly Series[], factor: number): uPlot.AlignedData {
    const tables = series.map(({ points }): uPlot.AlignedData => [
        points.map(({ at }) => at * factor),
        points.map(({ value }) => value),
    ]);
    const [one] = series;
    if (one === undefined) return [[]];
    if (series.length > 1) return uPlot.join(tables);
    const limit = (value: number | null) => one.points.map(() => value);
    return [...tables.flat(), limit(one.low), limit(one.high)] as uPlot.AlignedData;
}

/** A range with some room around it. */
export function padded(low: number | null, high: number | null): [number, number] {
    if (low === null || high === null || !Number.isFinite(low + high)) return [0, 1];
    const by = (high - low) * 0.08 || Math.abs(high) * 0.05 || 1;
    const range: [number, number] = [low - by, high + by];
    // Values near the largest number leave no room.
    return Number.isFinite(range[1] - range[0])
        ? range
        : [-Number.MAX_VALUE / 4, Number.MAX_VALUE / 4];
}

/** Draws a dashed vertical line at each of these x values. */
export function drawMarks(plot: uPlot, marks: readonly number[], colour: string): void {
    const { ctx: context, bbox } = plot;
    context.save();
    context.strokeStyle = colour;
    context.lineWidth = 1.5 * devicePixelRatio;
    context.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
    for (const mark of marks) {
        const x = Math.round(plot.valToPos(mark, 'x', true));
        if (x < bbox.left || x > bbox.left + bbox.width) continue;
        context.beginPath();
        context.moveTo(x, bbox.top);
        context.lineTo(x, bbox.top + bbox.height);
        context.stroke();
    }
    context.restore();
}

/** A part of the x axis. */
export interface Interval {
    from: number;
    to: number;
}

/** Shades parts of the x axis between two lines, which are visible if the part is narrow. */
export function drawIntervals(plot: uPlot, intervals: readonly Interval[], colour: string): void {
    const { ctx: context, bbox } = plot;
    const end = bbox.left + bbox.width;
    context.save();
    context.fillStyle = colour;
    for (const { from, to } of intervals) {
        const left = Math.max(bbox.left, Math.round(plot.valToPos(from, 'x', true)));
        const right = Math.min(end, Math.round(plot.valToPos(to, 'x', true)));
        if (left > end || right < bbox.left) continue;
        context.globalAlpha = 0.2;
        context.fillRect(left, bbox.top, right - left, bbox.height);
        context.globalAlpha = 0.8;
        const line = Math.round(devicePixelRatio);
        context.fillRect(left, bbox.top, line, bbox.height);
        context.fillRect(right - line, bbox.top, line, bbox.height);
    }
    context.restore();
}

/** Plots that are reset together, by link. */
class Linked {
    private readonly resets = new Map<string, Set<() => void>>();

    /** Joins until the returned function is called. */
    join(link: string, reset: () => void): () => void {
        const group = this.resets.get(link) ?? new Set();
        this.resets.set(link, group.add(reset));
        return () => group.delete(reset);
    }

    reset(link: string): void {
        for (const reset of this.resets.get(link) ?? []) reset();
    }
}

export const linked = new Linked();
