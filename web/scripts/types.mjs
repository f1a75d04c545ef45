// Writes the page's types from the JSON Schemas of the project, so that an
// event which changes there does not compile here until the page knows it.

import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { compile } from 'json-schema-to-typescript';

const SCHEMAS = new URL('../../schemas/', import.meta.url);
const TARGET = new URL('../src/generated/', import.meta.url);

/** A `$ref` with properties beside it means both; the compiler sees only one. */
function joinReferences(node) {
    if (Array.isArray(node)) return node.map(joinReferences);
    if (node === null || typeof node !== 'object') return node;
    const { $ref, properties, required, ...rest } = Object.fromEntries(
        Object.entries(node).map(([name, value]) => [name, joinReferences(value)]),
    );
    if ($ref !== undefined && properties !== undefined) {
        const own = { type: 'object', properties, required: required ?? [] };
        return { ...rest, type: undefined, allOf: [{ $ref }, own] };
    }
    return JSON.parse(JSON.stringify({ ...rest, $ref, properties, required }));
}

await mkdir(TARGET, { recursive: true });
for (const name of ['event']) {
    const schema = JSON.parse(await readFile(new URL(`${name}.json`, SCHEMAS), 'utf8'));
    const types = await compile(joinReferences(schema), name, { additionalProperties: false });
    await writeFile(new URL(`${name}.d.ts`, TARGET), types);
}
