// Lists of runs as they were left, for those who come back to them.

import type { RunInfo } from './api-types';

export interface Listed {
    runs: RunInfo[];
    next: string | undefined;
    chosen: string[];
    scroll: number;
}

const MOST = 10;

class Lists {
    private readonly all = new Map<string, Listed>();

    of(key: string): Listed | undefined {
        return this.all.get(key);
    }

    keep(key: string, list: Omit<Listed, 'scroll'>): void {
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

export const listed = new Lists();
