// Rates of campaigns as a plot over campaigns.

import type { CampaignChange, CampaignSeries, RatePoint } from '../../generated/api';
import { intervalText, percent as exact, rateAxes } from '../campaign';
import { pValue } from '../format';
import { percent } from './trends';

/** The height of a plot. */
export const HEIGHT = 180;

/** The changes of a series, the oldest first. */
export function changesOf(series: CampaignSeries, changes: CampaignChange[]): CampaignChange[] {
    const known = new Set(series.points.map(({ campaign }) => campaign));
    return changes.filter(({ campaign }) => known.has(campaign)).reverse();
}

/** Places rates with their intervals and the claims of their campaigns in a plot of this width, and
 *  the first campaigns after changes. Campaigns without a rate have no mark. */
export function drawRates(
    points: readonly RatePoint[],
    changes: readonly CampaignChange[],
    width: number,
) {
    const values = points.flatMap(({ rate, claim }) => [claim, ...(rate ? [rate.low] : [])]);
    const least = Math.min(1, ...values);
    // From 100 % down to a multiple of 5 % below all intervals.
    const floor = Math.max(0, Math.min(0.95, Math.floor(least * 20) / 20));
    const axes = rateAxes(width - 12, HEIGHT - 22, floor);
    const { left, right, y } = axes;
    const x = (index: number) => left + ((index + 0.5) / points.length) * (right - left);
    const marks = points.flatMap((point, index) => {
        const { rate, claim } = point;
        if (!rate) return [];
        const [low, high] = [y(rate.low), y(rate.high)];
        return [{ point, x: x(index), y: y(rate.value), low, high, claim: y(claim) }];
    });
    const starts = changes.map(({ campaign }) =>
        points.findIndex((point) => point.campaign === campaign),
    );
    const between = (right - left) / Math.max(1, points.length) / 2;
    const lines = starts.filter((index) => index >= 0).map((index) => x(index) - between);
    return { ...axes, marks, changes: lines };
}

/** `95 % (91 % to 98 %)`. */
export function rateText(rate: RatePoint['rate']): string {
    return rate ? intervalText(rate) : 'no result';
}

/** A change in words: `97.5 % → 37.5 % (-60 %)`, with the number of episodes. */
export function rateChangeText({ before, after, p_value: p }: CampaignChange): string {
    const [from, to] = [before.rate.value, after.rate.value];
    return `${exact(from)} → ${exact(to)} (${percent(to - from, true)}), ${pValue(p)}`;
}
