// The folded parts of the page, stored in the browser.

const KEY = 'rtf-folded';

function stored(): string[] {
    try {
        const list: unknown = JSON.parse(localStorage.getItem(KEY) ?? '[]');
        return Array.isArray(list) ? list.filter((each) => typeof each === 'string') : [];
    } catch {
        // Storage may be disabled or invalid: then nothing is folded.
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
        try {
            localStorage.setItem(KEY, JSON.stringify(this.names));
        } catch {
            // The state is kept until the page is closed.
        }
    }
}

export const foldState = new FoldState();
