// Keeps lists of runs, with their scroll positions, for when the user returns to them.

import type { RunInfo } from './api-types';
import { Recent } from './recent';

interface CachedList {
    runs: RunInfo[];
    next: string | undefined;
    chosen: string[];
    scroll: number;
}

const MOST = 10;

export const runListCache = new Recent<CachedList>(MOST);
