// Bundles the extension into dist/extension.js, and copies the project's schemas and licence,
// which the package contains.

import { cp, mkdir, rm } from 'node:fs/promises';
import { build } from 'esbuild';

const ROOT = new URL('../../../', import.meta.url);
const HERE = new URL('../', import.meta.url);

await rm(new URL('schemas/', HERE), { recursive: true, force: true });
await mkdir(new URL('schemas/', HERE));
for (const [from, to] of [
    ['spec/suite.xsd', 'schemas/suite.xsd'],
    ['schemas/config.json', 'schemas/config.json'],
    ['schemas/limits.json', 'schemas/limits.json'],
    ['LICENSE', 'LICENSE'],
]) {
    await cp(new URL(from, ROOT), new URL(to, HERE));
}
await build({
    absWorkingDir: new URL('.', HERE).pathname,
    entryPoints: ['src/extension.ts'],
    outfile: 'dist/extension.js',
    bundle: true,
    platform: 'node',
    format: 'cjs',
    target: 'node20',
    external: ['vscode'],
    minify: true,
    logLevel: 'warning',
});
