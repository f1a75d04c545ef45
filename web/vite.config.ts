import { svelte } from '@sveltejs/vite-plugin-svelte';
import { readFile } from 'node:fs/promises';
import type { Plugin } from 'vite';
import { defineConfig } from 'vitest/config';

/** The viewer of the API's description, next to the page (spec/web.md). */
const viewer: Plugin = {
    name: 'rapidoc',
    async generateBundle() {
        const file = new URL('node_modules/rapidoc/dist/rapidoc-min.js', import.meta.url);
        const source = await readFile(file);
        this.emitFile({ type: 'asset', fileName: 'rapidoc-min.js', source });
    },
};

export default defineConfig({
    // Relative, so that the page works below any path.
    base: './',
    plugins: [svelte(), viewer],
    build: {
        // Nothing inline: the page's policy is `default-src 'self'`.
        assetsInlineLimit: 0,
        modulePreload: { polyfill: false },
        sourcemap: false,
        license: { fileName: 'licenses.md' },
        target: 'es2022',
    },
    server: {
        // `npm run dev` next to an `rtf run --web` or `rtf serve`.
        proxy: { '/api': process.env['RTF_URL'] ?? 'http://127.0.0.1:8080' },
    },
    test: { include: ['src/**/*.test.ts'], environment: 'node' },
});
