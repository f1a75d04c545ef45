// The title of a run: what was run, not when.

import type { RunInfo } from './api-types';

const MOST_NAMES = 3;

/** Its suites, or its command. */
export function titleOf({ suite_names, suites, command, run }: RunInfo): string {
    if (suite_names.length === 0) return command.length === 0 ? run : command.slice(1).join(' ');
    const shown = suite_names.slice(0, MOST_NAMES).join(', ');
    const more = suites - Math.min(suite_names.length, MOST_NAMES);
    return more > 0 ? `${shown} and ${more} more` : shown;
}

/** The branch and the beginning of the commit: `main 0f3a91c`. */
export function revisionOf({ revision }: RunInfo): string {
    if (!revision?.commit) return '';
    const commit = revision.commit.slice(0, 8);
    return revision.branch == null ? commit : `${revision.branch} ${commit}`;
}
