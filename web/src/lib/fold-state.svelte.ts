// The folded parts of the page, stored in the browser.

import { load, store } from './storage';

const KEY = 'rtf-folded';

function stored(): string[] {
    try {
        const list: unknown = JSON.parse(load(KEY) ?? '[]');
        return Array.isArray(list) ? list.filter((each) => typeof each === 'string') : [];
    } catch {
        // It may be invalid: then nothing is folded.
        return [];
    }
}

class FoldState {
    private names: readonly string[] = $state.raw(stored());

    has(name: string): boolean {
        return this.names.includes(name);
    }

    set(name: string, isFolded: boolean): void {
        const others = this.names.filter((each) => each !== name);
        this.names = isFolded ? [...others, name] : others;
        store(KEY, JSON.stringify(this.names));
    }
}

export const foldState = new FoldState();
