// Questions to the history (spec/web.md).

import type {
    FlakyTests,
    HistoryCampaigns,
    HistoryComparison,
    HistoryMatrix,
    SeriesTrend,
    SlowTests,
    TestHistories,
} from '../../generated/api';
import { get, path } from '../api';
import type { Selection } from './query';

type Query = Record<string, string | number | undefined>;

function ask<T>(what: string, query: Query, signal: AbortSignal | null): Promise<T> {
    return get<T>(path(['history', what], query), signal);
}

export const matrixPage = (
    selection: Selection,
    page: { after: number; limit: number },
    signal: AbortSignal,
) => ask<HistoryMatrix>('matrix', { ...selection, ...page }, signal);

export const testHistory = (test: string, selection: Selection, signal: AbortSignal) =>
    ask<TestHistories>('test', { ...selection, test }, signal);

export const trend = (
    series: string,
    test: string | undefined,
    selection: Selection,
    signal: AbortSignal,
) => ask<SeriesTrend>('trend', { ...selection, series, test }, signal);

export const flaky = (selection: Selection, signal: AbortSignal) =>
    ask<FlakyTests>('flaky', { ...selection, limit: 1000 }, signal);

export const slow = (selection: Selection, signal: AbortSignal) =>
    ask<SlowTests>('slow', { ...selection, limit: 1000 }, signal);

export const campaigns = (selection: Selection, signal: AbortSignal) =>
    ask<HistoryCampaigns>('campaigns', { ...selection }, signal);

export const compare = (a: string, b: string, selection: Selection, signal: AbortSignal) =>
    ask<HistoryComparison>('compare', { ...selection, a, b }, signal);
