// The matrix of verdicts: tests in rows, runs in columns.

import type { HistoryMatrix, MatrixRun } from '../../generated/api';
import type { Verdict } from '../event';
import type { Selection } from './query';
import { testName } from './query';
import { ask } from './requests';

/** The letters of results (spec/web.md); `P` passed after a retry. */
export const LETTERS: Readonly<Record<string, Verdict>> = {
    p: 'passed',
    P: 'passed',
    f: 'failed',
    e: 'error',
    c: 'crashed',
    t: 'timed-out',
    x: 'collapsed',
    s: 'skipped',
    i: 'interrupted',
};

/** As many tests as any screen shows. */
const FIRST_PAGE = 60;
const PAGE = 1000;

export interface MatrixRow {
    name: string;
    /** One letter per run. */
    verdicts: string;
}

export interface Matrix {
    /** The oldest first. */
    runs: readonly MatrixRun[];
    rows: readonly MatrixRow[];
    robots: readonly string[];
    /** Whether the rest of the rows is still being loaded. */
    isPart: boolean;
}

/**
 * Loads the matrix: `show` is called with the first rows, and then with more. Starts again if
 * a run is added meanwhile.
 */
export async function loadMatrix(
    selection: Selection,
    show: (matrix: Matrix) => void,
    signal: AbortSignal,
): Promise<void> {
    let matrix: Matrix | null = null;
    for (let after: number | undefined = 0; after !== undefined;) {
        const limit = matrix === null ? FIRST_PAGE : PAGE;
        const query = { ...selection, after, limit };
        const page: HistoryMatrix = await ask('matrix', query, signal);
        if (matrix !== null && !hasSameRuns(matrix.runs, page.runs)) {
            [matrix, after] = [null, 0];
            continue;
        }
        matrix = extended(matrix, page);
        show(matrix);
        after = page.next;
    }
}

function hasSameRuns(a: readonly MatrixRun[], b: readonly MatrixRun[]): boolean {
    return a.length === b.length && a.every((run, index) => run.id === b[index]?.id);
}

/** The matrix with the rows of another page. */
export function extended(matrix: Matrix | null, page: HistoryMatrix): Matrix {
    const rows = page.tests.map((test) => ({ name: testName(test), verdicts: test.verdicts }));
    return {
        runs: page.runs,
        rows: [...(matrix?.rows ?? []), ...rows],
        robots: [...new Set([...(matrix?.robots ?? []), ...page.robots])].sort(),
        isPart: page.next !== undefined,
    };
}

/** Rows with a result that is a problem. */
export function withProblems(rows: readonly MatrixRow[]): MatrixRow[] {
    return rows.filter(({ verdicts }) => /[Pfectx]/.test(verdicts));
}

/** A result in words, for people who cannot see its colour. */
export function describe(letter: string | undefined): string {
    if (letter === 'P') return 'passed after a retry';
    return LETTERS[letter ?? '-'] ?? 'no result';
}
