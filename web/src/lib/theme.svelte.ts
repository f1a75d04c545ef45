// Light or dark theme: the system's, or the user's choice.

import { load, store } from './storage';

export type Choice = 'system' | 'light' | 'dark';

const KEY = 'rtf-theme';
const system = matchMedia('(prefers-color-scheme: dark)');

function stored(): Choice {
    const text = load(KEY);
    return text === 'light' || text === 'dark' ? text : 'system';
}

class Theme {
    choice: Choice = $state(stored());
    private systemIsDark = $state(system.matches);

    constructor() {
        system.addEventListener('change', () => (this.systemIsDark = system.matches));
        $effect.root(() => {
            $effect(() => {
                document.documentElement.dataset['theme'] = this.isDark ? 'dark' : 'light';
            });
        });
    }

    get isDark(): boolean {
        return this.choice === 'system' ? this.systemIsDark : this.choice === 'dark';
    }

    choose(choice: Choice): void {
        this.choice = choice;
        store(KEY, choice === 'system' ? null : choice);
    }
}

export const theme = new Theme();
