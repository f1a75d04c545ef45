import { svelte } from '@sveltejs/vite-plugin-svelte';
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vite';
import { singleFile } from './scripts/single-file.ts';

/** Written by the build of the page that is served, which has the same packages. */
const licences = new URL('dist/licenses.md', import.meta.url);

// The page as a report: one file, into which rtf writes the data of a run (spec/reports.md).
export default defineConfig({
    base: './',
    publicDir: false,
    plugins: [svelte(), singleFile('report.html', licences)],
    resolve: {
        alias: [
            {
                find: /^.*\/shared-stream$/,
                replacement: fileURLToPath(new URL('src/lib/report/no-stream.ts', import.meta.url)),
            },
        ],
    },
    build: {
        // Next to the page that is served.
        emptyOutDir: false,
        assetsInlineLimit: () => true,
        cssCodeSplit: false,
        modulePreload: { polyfill: false },
        sourcemap: false,
        target: 'es2022',
        rolldownOptions: { input: 'report.html', output: { codeSplitting: false } },
    },
});
