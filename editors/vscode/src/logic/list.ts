// Parses the output of `rtf list --format json` (docs/running.md).

/** A position in a source file; `line` is from 1, or 0 if it is unknown. */
export interface Location {
    file: string;
    line: number;
}

/** A case that is known before its test runs. */
export interface ListedCase {
    name: string;
    location?: Location;
    disabled?: boolean;
}

export interface ListedTest {
    suite: string;
    name: string;
    /** The line of its `<test>`, from 1; 0 if `rtf` is too old to report it. */
    line: number;
    type: string;
    plugin: string;
    tags: string[];
    cases: ListedCase[];
}

/** Returns the tests in the order of their suite. Throws if the text is not a list of tests. */
export function parseList(text: string): ListedTest[] {
    const list: unknown = JSON.parse(text);
    if (!isObject(list) || !Array.isArray(list['tests'])) throw new Error('no list of tests');
    return list['tests'].map(parseTest);
}

function parseTest(test: unknown): ListedTest {
    if (!isObject(test) || typeof test['name'] !== 'string') throw new Error('no list of tests');
    const cases = Array.isArray(test['cases']) ? test['cases'] : [];
    return {
        suite: text(test['suite']),
        name: test['name'],
        line: typeof test['line'] === 'number' ? test['line'] : 0,
        type: text(test['type']),
        plugin: text(test['plugin']),
        tags: Array.isArray(test['tags']) ? test['tags'].map(text) : [],
        cases: cases.filter(isObject).map(parseCase),
    };
}

function parseCase(listed: Record<string, unknown>): ListedCase {
    const { location } = listed;
    return {
        name: text(listed['name']),
        ...(isObject(location)
            ? { location: { file: text(location['file']), line: Number(location['line'] ?? 0) } }
            : {}),
        ...(listed['disabled'] === true ? { disabled: true } : {}),
    };
}

function isObject(value: unknown): value is Record<string, unknown> {
    return typeof value === 'object' && value !== null && !Array.isArray(value);
}

function text(value: unknown): string {
    return typeof value === 'string' ? value : '';
}
