// The routes of the page, after the `#` of its address.

import {
    historyHref,
    parseQuery,
    parseView,
    type HistoryQuery,
    type HistoryView,
} from './history/query';
import { filterQuery, parseFilter, type RunFilter } from './run-filter';

export type Route =
    | { at: 'home' }
    | { at: 'runs'; filter: RunFilter; problems?: string[] }
    | { at: 'run'; run: string; show: Shown }
    | { at: 'compare'; old: string; new: string }
    | { at: 'campaign'; name: string }
    | { at: 'history'; view: HistoryView; query: HistoryQuery };

/** The selected part of a run. */
export type Shown =
    | { what: 'overview' }
    /** `case` is one of the attempt, such as an episode of a batch. */
    | { what: 'test'; id: number; attempt: number | null; case?: number }
    | { what: 'fixture'; id: number }
    | { what: 'hook'; id: number };

export function parseRoute(hash: string): Route {
    const [, route = '', query = ''] = /^#?\/?([^?]*)\??(.*)$/s.exec(hash) ?? [];
    const parts = route.split('/').map(decode);
    const [where, first, kind, second] = parts;
    if (where === 'compare' && first && kind) return { at: 'compare', old: first, new: kind };
    if (where === 'runs' && first) {
        return { at: 'run', run: first, show: shown(kind, second, new URLSearchParams(query)) };
    }
    if (where === 'campaigns' && first) return { at: 'campaign', name: first };
    if (where === 'history') {
        return { at: 'history', view: parseView(first), query: parseQuery(query) };
    }
    if (where !== 'runs') return { at: 'home' };
    const { filter, problems } = parseFilter(query);
    return problems.length === 0 ? { at: 'runs', filter } : { at: 'runs', filter, problems };
}

function shown(kind: string | undefined, text: string | undefined, query: URLSearchParams): Shown {
    const id = Number(text);
    if (text === undefined || !Number.isInteger(id) || id < 0) return { what: 'overview' };
    if (kind === 'tests') {
        const attempt = positive(query.get('attempt'));
        const found = positive(query.get('case'));
        // The cases of each attempt are numbered from 1.
        const part = attempt === null || found === null ? {} : { case: found };
        return { what: 'test', id, attempt, ...part };
    }
    if (kind === 'fixtures') return { what: 'fixture', id };
    if (kind === 'hooks') return { what: 'hook', id };
    return { what: 'overview' };
}

function positive(text: string | null): number | null {
    const number = Number(text);
    return Number.isInteger(number) && number > 0 ? number : null;
}

function decode(part: string): string {
    try {
        return decodeURIComponent(part);
    } catch {
        return part;
    }
}

export function hrefOf(route: Route): string {
    const run = (name: string) => encodeURIComponent(name);
    switch (route.at) {
        case 'home':
            return '#/';
        case 'runs': {
            const query = filterQuery(route.filter);
            return query === '' ? '#/runs' : `#/runs?${query}`;
        }
        case 'compare':
            return `#/compare/${run(route.old)}/${run(route.new)}`;
        case 'campaign':
            return `#/campaigns/${run(route.name)}`;
        case 'history':
            return historyHref(route.view, route.query);
        case 'run':
            return `#/runs/${run(route.run)}${tail(route.show)}`;
    }
}

function tail(show: Shown): string {
    if (show.what === 'overview') return '';
    const base = `/${show.what}s/${show.id}`;
    if (show.what !== 'test' || show.attempt === null) return base;
    const part = show.case === undefined ? '' : `&case=${show.case}`;
    return `${base}?attempt=${show.attempt}${part}`;
}

/** The directory of the campaign of which a run is a part. */
export function campaignOf(run: string): string | undefined {
    return /^campaigns\/([^/]+)\/workers\//.exec(run)?.[1];
}

export const testHref = (run: string, id: number, attempt: number | null = null) =>
    hrefOf({ at: 'run', run, show: { what: 'test', id, attempt } });
export const caseHref = (run: string, id: number, attempt: number, number: number) =>
    hrefOf({ at: 'run', run, show: { what: 'test', id, attempt, case: number } });
export const fixtureHref = (run: string, id: number) =>
    hrefOf({ at: 'run', run, show: { what: 'fixture', id } });
export const hookHref = (run: string, id: number) =>
    hrefOf({ at: 'run', run, show: { what: 'hook', id } });
export const runHref = (run: string) => hrefOf({ at: 'run', run, show: { what: 'overview' } });
