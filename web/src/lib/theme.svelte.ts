// Light or dark theme: the system's, or the user's choice.

export type Choice = 'system' | 'light' | 'dark';

const KEY = 'rtf-theme';
const system = matchMedia('(prefers-color-scheme: dark)');

function stored(): Choice {
    try {
        const text = localStorage.getItem(KEY);
        return text === 'light' || text === 'dark' ? text : 'system';
    } catch {
        // Storage may be disabled: then the system's theme is used.
        return 'system';
    }
}

class Theme {
    choice: Choice = $state(stored());
    private systemIsDark = $state(system.matches);

    constructor() {
        system.addEventListener('change', () => (this.systemIsDark = system.matches));
    }

    get isDark(): boolean {
        return this.choice === 'system' ? this.systemIsDark : this.choice === 'dark';
    }

    choose(choice: Choice): void {
        this.choice = choice;
        try {
            if (choice === 'system') localStorage.removeItem(KEY);
            else localStorage.setItem(KEY, choice);
        } catch {
            // The choice is kept until the page is closed.
        }
    }
}

export const theme = new Theme();
