// Parts of the page that the reader has folded, kept for the next visit.

const KEY = 'rtf-folded';

function stored(): string[] {
    try {
        const list: unknown = JSON.parse(localStorage.getItem(KEY) ?? '[]');
        return Array.isArray(list) ? list.filter((each) => typeof each === 'string') : [];
    } catch {
        // Storage may be forbidden, or hold nonsense: then nothing is folded.
        return [];
    }
}

class Folded {
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
            // It holds until the page is closed.
        }
    }
}

export const folded = new Folded();
