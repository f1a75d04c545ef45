// The part of the page's address that selects a view of the history, runs and tests.

/** The parts of the History page. */
export const VIEWS = ['matrix', 'flaky', 'slow', 'compare', 'test', 'trend', 'campaigns'] as const;
export type HistoryView = (typeof VIEWS)[number];

/** Which runs and tests: as in the API (spec/web.md). */
export const SELECTION_NAMES = [
    'filter',
    'branch',
    'commit',
    'robot',
    'profile',
    'host',
    'since',
    'last',
    'cases',
] as const;

/** What a view shows: a test, a measurement, the two sides of a comparison. */
export const SUBJECT_NAMES = ['test', 'series', 'a', 'b'] as const;

const NAMES = [...SUBJECT_NAMES, ...SELECTION_NAMES] as const;

export type SelectionName = (typeof SELECTION_NAMES)[number];
export type Selection = Partial<Record<SelectionName, string>>;
export type HistoryQuery = Partial<Record<(typeof NAMES)[number], string>>;

export function parseView(text: string | undefined): HistoryView {
    return VIEWS.find((view) => view === text) ?? 'matrix';
}

/** The known parts of a query; unknown ones and empty values are ignored. */
export function parseQuery(text: string): HistoryQuery {
    const query: HistoryQuery = {};
    const given = new URLSearchParams(text);
    for (const name of NAMES) {
        const value = given.get(name)?.trim();
        if (value) query[name] = value;
    }
    return query;
}

/** The query of an address, in one order. */
export function formatQuery(query: HistoryQuery): string {
    const pairs = new URLSearchParams();
    for (const name of NAMES) {
        const value = query[name]?.trim();
        if (value) pairs.set(name, value);
    }
    return pairs.toString();
}

/** The query without what a view shows. */
export function selectionOf(query: HistoryQuery): Selection {
    const pairs = SELECTION_NAMES.flatMap((name) =>
        query[name] === undefined ? [] : [[name, query[name]] as const],
    );
    return Object.fromEntries(pairs);
}

/** The address of a view, after the `#`. */
export function historyHref(view: HistoryView, query: HistoryQuery = {}): string {
    const text = formatQuery(query);
    const place = view === 'matrix' ? '#/history' : `#/history/${view}`;
    return text === '' ? place : `${place}?${text}`;
}

interface Identity {
    suite: string;
    test: string;
    case?: string;
}

/** The name of a test or case: `SUITE/TEST::CASE`. */
export function testName({ suite, test, case: path = '' }: Identity): string {
    return path === '' ? `${suite}/${test}` : `${suite}/${test}::${path}`;
}
