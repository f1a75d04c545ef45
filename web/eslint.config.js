import svelte from 'eslint-plugin-svelte';
import ts from 'typescript-eslint';
import config from './svelte.config.js';

export default ts.config(
    { ignores: ['dist/', 'src/generated/', 'node_modules/'] },
    ...ts.configs.recommended,
    ...svelte.configs.recommended,
    {
        files: ['**/*.svelte', '**/*.svelte.ts'],
        languageOptions: {
            parserOptions: { parser: ts.parser, svelteConfig: config },
        },
    },
    {
        rules: {
            'max-lines': ['error', 300],
            'max-params': ['error', 5],
            // Sets and maps are replaced as a whole, which Svelte notices.
            'svelte/prefer-svelte-reactivity': 'off',
            // Output of a test must never become markup.
            'svelte/no-at-html-tags': 'error',
            'no-restricted-properties': [
                'error',
                { property: 'innerHTML' },
                { property: 'outerHTML' },
                { property: 'insertAdjacentHTML' },
            ],
        },
    },
);
