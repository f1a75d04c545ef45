// The filter of the list of runs, which the page's address contains.

/** The result of a run, or that it is running. */
export const RUN_RESULTS = ['running', 'green', 'red', 'interrupted', 'died', 'damaged'] as const;

export const FILTER_NAMES = [
    'q',
    'result',
    'suite',
    'branch',
    'commit',
    'robot',
    'profile',
    'since',
    'until',
] as const;

export type FilterName = (typeof FILTER_NAMES)[number];
export type RunFilter = Partial<Record<FilterName, string>>;

/** A filter, and the problems of its invalid parts. */
export function parseFilter(query: string) {
    const filter: RunFilter = {};
    const problems: string[] = [];
    for (const [name, text] of new URLSearchParams(query)) {
        const value = text.trim();
        if (!isName(name)) {
            problems.push(`there is no filter “${name}”`);
            continue;
        }
        if (value === '') continue;
        const problem = problemOf(name, value);
        if (problem === null) filter[name] = value;
        else problems.push(problem);
    }
    return { filter, problems };
}

function isName(name: string): name is FilterName {
    return (FILTER_NAMES as readonly string[]).includes(name);
}

/** The problem of a value; `null` if it is valid. */
export function problemOf(name: FilterName, value: string): string | null {
    if (name === 'result' && !(RUN_RESULTS as readonly string[]).includes(value))
        return `“${value}” is no result: ${RUN_RESULTS.join(', ')}`;
    if (name === 'commit' && !/^[0-9a-f]{4,64}$/i.test(value))
        return `“${value}” is no commit: 4 to 64 hexadecimal digits`;
    if ((name === 'since' || name === 'until') && !isDay(value))
        return `“${value}” is no day: like 2026-11-21`;
    return null;
}

function isDay(text: string): boolean {
    if (!/^\d{4}-\d{2}-\d{2}$/.test(text)) return false;
    const day = new Date(`${text}T00:00:00Z`);
    return !Number.isNaN(day.getTime()) && day.toISOString().startsWith(text);
}

/** The query of an address, in one order. */
export function filterQuery(filter: RunFilter): string {
    const query = new URLSearchParams();
    for (const name of FILTER_NAMES) {
        const value = filter[name]?.trim();
        if (value) query.set(name, value);
    }
    return query.toString();
}
