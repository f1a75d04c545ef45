// Keeps lists of runs, with their scroll positions, for when the user returns to them.

import type { RunInfo } from './api-types';

export interface CachedList {
    runs: RunInfo[];
    next: string | undefined;
    chosen: string[];
    scroll: number;
}

const MOST = 10;

class RunListCache {
    private readonly all = new Map<string, CachedList>();

    get(key: string): CachedList | undefined {
        return this.all.get(key);
    }

    keep(key: string, list: Omit<CachedList, 'scroll'>): void {
        const scroll = this.all.get(key)?.scroll ?? 0;
        this.all.delete(key);
        this.all.set(key, { ...list, scroll });
        for (const old of this.all.keys()) {
            if (this.all.size <= MOST) break;
            this.all.delete(old);
        }
    }

    scrolled(key: string, scroll: number): void {
        const list = this.all.get(key);
        if (list !== undefined) list.scroll = scroll;
    }
}

export const runListCache = new RunListCache();
