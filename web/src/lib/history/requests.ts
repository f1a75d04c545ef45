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
import { get, path, type Query } from '../api';

/** The answer to each question. */
interface Answers {
    matrix: HistoryMatrix;
    test: TestHistories;
    trend: SeriesTrend;
    flaky: FlakyTests;
    slow: SlowTests;
    campaigns: HistoryCampaigns;
    compare: HistoryComparison;
}

export type Question = keyof Answers;
export type Answer<Q extends Question> = Answers[Q];

export function ask<Q extends Question>(question: Q, query: Query, signal: AbortSignal) {
    return get<Answer<Q>>(path(['history', question], query), signal);
}
