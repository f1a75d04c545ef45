// What makes results of different runs comparable.
import type { ComparedRuns, FlakyTest } from '../../generated/api';
import { count } from '../format';

const WITHOUT = 'without a commit or with uncommitted changes';

/** The basis of a test's pairs, if it is not the commit of all of them. */
export function basis({ pairs, pairs_by_sources: some }: FlakyTest): string {
    if (!some) return '';
    return some === pairs ? 'with equal sources' : `(${some} with equal sources)`;
}

/** How runs without a clean commit were compared. */
export function comparedText({ by_sources, neither }: ComparedRuns): string[] {
    const lines = [];
    if (by_sources > 0)
        lines.push(
            `Compared if the sources of a test are equal (suite, plug-ins, their modules), ${WITHOUT}: ${count(by_sources, 'run')}.`,
        );
    if (neither > 0)
        lines.push(`Not compared with other runs, ${WITHOUT}: ${count(neither, 'run')}.`);
    return lines;
}
