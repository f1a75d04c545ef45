// What the browser stores for the page. Storage may be disabled.

/** A stored text; `null` without one. */
export function load(key: string): string | null {
    try {
        return localStorage.getItem(key);
    } catch {
        return null;
    }
}

/** Stores a text, or removes it. Without storage, the page keeps it until it is closed. */
export function store(key: string, text: string | null): void {
    try {
        if (text === null) localStorage.removeItem(key);
        else localStorage.setItem(key, text);
    } catch {
        // The state is in the page, too.
    }
}
