// Rates of campaigns as a plot over campaigns.

import type { CampaignChange, CampaignSeries, RatePoint } from '../../generated/api';
import { percent } from './trends';

/** The height of a plot. */
export const HEIGHT = 180;
const [LEFT, RIGHT, TOP, BOTTOM] = [48, 12, 8, 22];

/** A rate with its interval, in pixels. */
export interface RateMark {
    point: RatePoint;
    x: number;
    y: number;
    low: number;
    high: number;
    /** The claimed rate of this campaign. */
    claim: number;
}

export interface RateDrawing {
    marks: RateMark[];
    /** Lines at rates. */
    ticks: { y: number; text: string }[];
    /** The first campaigns after changes. */
    changes: number[];
    left: number;
    right: number;
    bottom: number;
}

/** The changes of a series, the oldest first. */
export function changesOf(series: CampaignSeries, changes: CampaignChange[]): CampaignChange[] {
    const known = new Set(series.points.map(({ campaign }) => campaign));
    return changes.filter(({ campaign }) => known.has(campaign)).reverse();
}

/** Places rates in a plot of this width. Campaigns without a rate have no mark. */
export function drawRates(
    points: readonly RatePoint[],
    changes: readonly CampaignChange[],
    width: number,
): RateDrawing {
    const values = points.flatMap(({ rate, claim }) => [claim, ...(rate ? [rate.low] : [])]);
    const least = Math.min(1, ...values);
    // From 100 % down to a multiple of 5 % below all intervals.
    const floor = Math.max(0, Math.min(0.95, Math.floor(least * 20) / 20));
    const [right, bottom] = [Math.max(LEFT + 1, width - RIGHT), HEIGHT - BOTTOM];
    const y = (rate: number) => bottom - ((rate - floor) / (1 - floor)) * (bottom - TOP);
    const x = (index: number) => LEFT + ((index + 0.5) / points.length) * (right - LEFT);
    const marks = points.flatMap((point, index) => {
        const { rate, claim } = point;
        if (!rate) return [];
        const [low, high] = [y(rate.low), y(rate.high)];
        return [{ point, x: x(index), y: y(rate.value), low, high, claim: y(claim) }];
    });
    const ticks = [0, 1, 2, 3, 4].map((step) => {
        const rate = floor + (step / 4) * (1 - floor);
        return { y: y(rate), text: `${+(rate * 100).toFixed(2)} %` };
    });
    const starts = changes.map(({ campaign }) =>
        points.findIndex((point) => point.campaign === campaign),
    );
    const between = (right - LEFT) / Math.max(1, points.length) / 2;
    const lines = starts.filter((index) => index >= 0).map((index) => x(index) - between);
    return { marks, ticks, changes: lines, left: LEFT, right, bottom };
}

/** `95 % (91 % to 98 %)`. */
export function rateText(rate: RatePoint['rate']): string {
    if (!rate) return 'no result';
    return `${exact(rate.value)} (${exact(rate.low)} to ${exact(rate.high)})`;
}

/** A rate with one decimal. */
function exact(rate: number): string {
    return `${(rate * 100).toFixed(1)} %`;
}

/** A change in words: `97.5 % → 37.5 % (-60 %)`, with the number of episodes. */
export function rateChangeText({ before, after, p_value: p }: CampaignChange): string {
    const [from, to] = [before.rate.value, after.rate.value];
    const chance = p < 0.0001 ? 'p < 0.0001' : `p = ${p.toFixed(4)}`;
    return `${exact(from)} → ${exact(to)} (${percent(to - from, true)}), ${chance}`;
}
