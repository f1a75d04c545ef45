// The results of one campaign as plots.

import type { CampaignMap, CampaignReport, EpisodeRanking, EpisodeRun } from '../generated/api';
import { caseHref, runHref, testHref } from './route';

/** The height of the plot of the progress. */
export const HEIGHT = 200;
const LEFT = 48;
const TOP = 8;

/** The page of an episode: the test that did not pass or shows it, in the run of its worker, and
 *  the case of it that the episode is. */
export function episodeHref({ run, test, attempt, case: number }: EpisodeRun): string {
    if (test === undefined) return runHref(run);
    if (attempt === undefined || number === undefined) return testHref(run, test, attempt ?? null);
    return caseHref(run, test, attempt, number);
}

/** `payload=1.2 surface=wood`. */
export function parametersText(parameters: Record<string, string>): string {
    return Object.entries(parameters)
        .map(([name, value]) => `${name}=${value}`)
        .join(' ');
}

/** What episodes are ordered by: `Carry error (rad)`. */
export function valueName({ by, unit }: Pick<EpisodeRanking, 'by' | 'unit'>): string {
    return unit === '' ? by : `${by} (${unit})`;
}

/** How episodes are ordered. */
export function rankingOrder({ by, higher_is_worse, worst, best }: EpisodeRanking): string {
    const values = higher_is_worse ? 'higher' : 'lower';
    const order = `Failed episodes are worse than passed ones, then ${values} values`;
    // Without one of both results, nothing shows which values are worse.
    const isShown = by !== 'duration' && worst[0]?.outcome !== best[0]?.outcome;
    return isShown ? `${order}, which failed episodes have on average.` : `${order}.`;
}

/** A rate in percent, with one decimal. */
export function percent(rate: number): string {
    return `${(rate * 100).toFixed(1)} %`;
}

/** `95.0 % (91.0 % to 98.0 %)`. */
export function intervalText(rate: { value: number; low: number; high: number }): string {
    return `${percent(rate.value)} (${percent(rate.low)} to ${percent(rate.high)})`;
}

/** The axes of a plot of rates, from `floor` up to 100 %, in pixels. */
export interface RateAxes {
    left: number;
    right: number;
    bottom: number;
    /** Lines at rates. */
    ticks: { y: number; text: string }[];
    /** The place of a rate. */
    y: (rate: number) => number;
}

/** Places the axes in a plot of this size, without its margins. */
export function rateAxes(right: number, bottom: number, floor = 0): RateAxes {
    const y = (rate: number) => bottom - ((rate - floor) / (1 - floor)) * (bottom - TOP);
    const ticks = [0, 0.25, 0.5, 0.75, 1].map((step) => {
        const rate = floor + step * (1 - floor);
        return { y: y(rate), text: `${+(rate * 100).toFixed(2)} %` };
    });
    return { left: LEFT, right: Math.max(LEFT + 1, right), bottom, ticks, y };
}

/** Places the progress of a rate in a plot of this width: the points of the rate, and of the
 *  area of its interval. */
export function drawProgress({ progress, claim }: CampaignReport, width: number) {
    const axes = rateAxes(width - 14, HEIGHT - 24);
    const { left, right, y } = axes;
    const most = progress.at(-1)?.episodes ?? 1;
    const place = (episodes: number, rate: number) =>
        `${(left + (episodes / most) * (right - left)).toFixed(1)},${y(rate).toFixed(1)}`;
    const line = progress.map(({ episodes, rate }) => place(episodes, rate.value));
    const upper = progress.map(({ episodes, rate }) => place(episodes, rate.high));
    const lower = progress.map(({ episodes, rate }) => place(episodes, rate.low)).reverse();
    const band = [...upper, ...lower].join(' ');
    return { ...axes, line: line.join(' '), band, claim: y(claim ?? 0) };
}

/** The map of two parameters, in which either may be that of the columns. */
export function mapOf(maps: readonly CampaignMap[], x: string, y: string) {
    const found = maps.find((map) => [x, y].includes(map.x) && [x, y].includes(map.y) && x !== y);
    if (found === undefined) return null;
    const names = found.rows[0]?.cells.map(({ values }) => values) ?? [];
    if (found.x === x) return { columns: names, rows: found.rows };
    const rows = names.map((values, index) => ({
        values,
        cells: found.rows.flatMap((row) => row.cells[index] ?? []),
    }));
    return { columns: found.rows.map(({ values }) => values), rows };
}

/** The names of the parameters that have maps. */
export function mapped(maps: readonly CampaignMap[]): string[] {
    return [...new Set(maps.flatMap(({ x, y }) => [x, y]))];
}
