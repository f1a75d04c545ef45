// Generates the page's types from the JSON Schemas of the project and the API's
// description, so that a change there is a compile error here until the page
// supports it.

import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { compile } from 'json-schema-to-typescript';

const SCHEMAS = new URL('../../schemas/', import.meta.url);
const TARGET = new URL('../src/generated/', import.meta.url);

/** A copy in which `change` replaces each object, after the objects in it. */
function mapObjects(node, change) {
    if (Array.isArray(node)) return node.map((each) => mapObjects(each, change));
    if (node === null || typeof node !== 'object') return node;
    const parts = Object.entries(node).map(([name, value]) => [name, mapObjects(value, change)]);
    return change(Object.fromEntries(parts));
}

/** A `$ref` with sibling properties means both; the compiler reads only one. */
function joinReferences({ $ref, properties, required, ...rest }) {
    if ($ref !== undefined && properties !== undefined) {
        const own = { type: 'object', properties, required: required ?? [] };
        return { ...rest, type: undefined, allOf: [{ $ref }, own] };
    }
    return JSON.parse(JSON.stringify({ ...rest, $ref, properties, required }));
}

/** A property without keywords is any JSON value; the compiler would make it an object. */
function typeAnyValues(node) {
    for (const property of Object.values(node.properties ?? {})) {
        const isAny = Object.keys(property).every((keyword) => keyword === 'description');
        if (isAny) property.tsType = 'unknown';
    }
    return node;
}

/** The API omits missing values, and never sends null (spec/web.md). */
function leaveOutNull(node) {
    // Other keywords next to a reference would create another type.
    if (node.$ref !== undefined) return { $ref: node.$ref };
    const clear = { ...node };
    if (Array.isArray(clear.type)) clear.type = clear.type.filter((each) => each !== 'null');
    if (Array.isArray(clear.oneOf)) {
        const others = clear.oneOf.filter((each) => each.type !== 'null');
        if (others.length === 1) return others[0];
        clear.oneOf = others;
    }
    return clear;
}

/** All schemas of the API's description, without null in the API's types. */
async function api() {
    const { components } = await read('openapi');
    const { $defs: model } = await read('event');
    const schemas = Object.entries(components.schemas).map(([name, schema]) => [
        name,
        name in model || name === 'Event' ? schema : mapObjects(schema, leaveOutNull),
    ]);
    const text = JSON.stringify(Object.fromEntries(schemas));
    const $defs = JSON.parse(text.replaceAll('#/components/schemas/', '#/$defs/'));
    // Types without a reference would be left out.
    const all = Object.keys($defs).map((name) => [name, { $ref: `#/$defs/${name}` }]);
    return { title: 'Api', type: 'object', properties: Object.fromEntries(all), $defs };
}

async function read(name) {
    return JSON.parse(await readFile(new URL(`${name}.json`, SCHEMAS), 'utf8'));
}

await mkdir(TARGET, { recursive: true });
for (const [name, schema] of [
    ['event', await read('event')],
    ['api', await api()],
]) {
    const clear = mapObjects(mapObjects(schema, typeAnyValues), joinReferences);
    const types = await compile(clear, name, { additionalProperties: false });
    await writeFile(new URL(`${name}.d.ts`, TARGET), types);
}
