// Requests to the server that the page came from (spec/web.md), or to the data in a report.

import type { RunFilter } from './run-filter';
import type {
    ApiRoot,
    Measurements,
    RunList,
    Snapshot,
    Started,
    TestDetail,
    TestPage,
} from './api-types';

const BASE = '/api/v1';

/** An error response, or no response (`status` 0). */
export class ApiError extends Error {
    constructor(
        readonly status: number,
        message: string,
    ) {
        super(message);
    }
}

/** Responds to a request for a path with the server's JSON. */
export type Source = (path: string) => Promise<unknown>;

let embedded: Source | null = null;

/** Reads from here instead of from a server. */
export function readFrom(source: Source): void {
    embedded = source;
}

/** Whether this page is a report: it has one run, and no server. */
export const isReport = () => embedded !== null;

declare global {
    /** Requests that `public/early.js` has started, by their addresses. */
    var rtfEarly: Map<string, Promise<Response>> | undefined;
}

/** Takes the response of a request that was started while the page was loaded, once. */
function takeEarly(address: string): Promise<Response> | undefined {
    const response = globalThis.rtfEarly?.get(address);
    globalThis.rtfEarly?.delete(address);
    return response;
}

async function request(path: string, options: RequestInit = {}): Promise<Response> {
    const { method, signal } = options;
    let response: Response;
    try {
        const early = method === undefined ? takeEarly(BASE + path) : undefined;
        response = await (early ?? fetch(BASE + path, options));
        signal?.throwIfAborted();
    } catch (problem) {
        if (signal?.aborted) throw problem;
        throw new ApiError(0, 'the server does not answer');
    }
    if (!response.ok) throw new ApiError(response.status, await reason(response));
    return response;
}

/** The problem in an error's body. */
async function reason(response: Response): Promise<string> {
    const text = await response.text().catch(() => '');
    try {
        const problem: unknown = JSON.parse(text);
        if (typeof problem === 'object' && problem !== null) {
            const { detail, title, hint } = problem as Record<string, unknown>;
            const words = [detail ?? title, hint].filter((each) => typeof each === 'string');
            if (words.length > 0) return words.join('; ');
        }
    } catch {
        // Not JSON: only the status is known.
    }
    return `the server answers ${response.status} ${response.statusText}`.trim();
}

export async function get<T>(path: string, signal: AbortSignal | null = null): Promise<T> {
    if (embedded !== null) return (await embedded(path)) as T;
    return (await (await request(path, { signal })).json()) as T;
}

export type Query = Record<string, string | number | undefined>;

/** A path with encoded parts and a query. */
export function path(parts: (string | number)[], query: Query = {}): string {
    const route = parts.map((part) => `/${encodeURIComponent(part)}`).join('');
    const pairs = Object.entries(query).flatMap(([name, value]) =>
        value === undefined ? [] : [`${name}=${encodeURIComponent(value)}`],
    );
    return pairs.length === 0 ? route : `${route}?${pairs.join('&')}`;
}

/** The address of a route, for links and streams. */
export function address(parts: (string | number)[], query: Query = {}): string {
    return BASE + path(parts, query);
}

export const root = () => get<ApiRoot>('');

export const runs = (before?: string, limit = 50, filter: RunFilter = {}) =>
    get<RunList>(path(['runs'], { limit, before, ...filter }));

export const snapshot = (run: string, signal: AbortSignal | null = null) =>
    get<Snapshot>(path(['runs', run, 'snapshot']), signal);

export const test = (run: string, id: number, signal: AbortSignal | null = null) =>
    get<TestDetail>(path(['runs', run, 'tests', id]), signal);

/** The tests with a case whose path contains these words; the first 1000. */
export async function testsWithCase(run: string, words: string, signal: AbortSignal) {
    const route = path(['runs', run, 'tests'], { case: words, limit: 1000 });
    const { tests } = await get<TestPage>(route, signal);
    return new Set(tests.map(({ id }) => id));
}

/** The first 1000 measurements of an attempt. */
export async function measurements(run: string, test: number, attempt: number) {
    const route = ['runs', run, 'tests', test, 'attempts', attempt, 'measurements'];
    const page = await get<Measurements>(path(route, { limit: 1000 }));
    return page.measurements;
}

const post = (route: (string | number)[], body: unknown = {}) =>
    request(path(route), {
        method: 'POST',
        headers: { 'Content-Type': 'application/json' },
        body: JSON.stringify(body),
    });

export const signIn = (token: string) => post(['session'], { token });

export const signOut = () => request('/session', { method: 'DELETE' });

export const stopRun = (run: string) => post(['runs', run, 'stop']);

/** Reruns the failed tests of a past run; returns the new run's name. */
export async function rerun(run: string): Promise<string> {
    const asked = await post(['runs', run, 'rerun']);
    return ((await asked.json()) as Started).run;
}

export const stopTest = (run: string, id: number) => post(['runs', run, 'tests', id, 'stop']);

/** Answers a question that waits for an answer. */
export const answer = (run: string, test: number, question: number, text: string) =>
    post(['runs', run, 'tests', test, 'questions', question, 'answer'], { answer: text });

export const skipSuite = (run: string, id: number) => post(['runs', run, 'suites', id, 'skip']);
