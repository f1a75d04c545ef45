// The schema of rtf.toml: valid in Ajv's strict mode, as SchemaStore requires, and in agreement
// with the project's own files. So are the catalogues.

import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { Ajv } from 'ajv';
import { parse } from 'smol-toml';
import { expect, test } from 'vitest';
import { version } from '../../package.json';

const ROOT = new URL('../../../../', import.meta.url);
const read = (path: string): string => readFileSync(new URL(path, ROOT), 'utf8');
const schema = JSON.parse(read('schemas/config.json'));
const validate = new Ajv({ strict: true, allowUnionTypes: true }).compile(schema);

function problems(text: string): string[] {
    // Dates are text for the schema, as in editors.
    validate(JSON.parse(JSON.stringify(parse(text))));
    return (validate.errors ?? []).map((each) => `${each.instancePath} ${each.message}`);
}

const EXAMPLES = readdirSync(new URL('examples/', ROOT))
    .map((example) => `examples/${example}/rtf.toml`)
    .filter((path) => existsSync(new URL(path, ROOT)));

test.each(EXAMPLES)('%s is valid', (path) => {
    expect(problems(read(path))).toEqual([]);
});

test('the examples of the specification are valid', () => {
    const blocks = [...read('spec/config.md').matchAll(/```toml\n([\s\S]*?)```/g)];
    expect(blocks.length).toBeGreaterThan(1);
    for (const [, text = ''] of blocks) expect(problems(text)).toEqual([]);
});

test.each([
    ['jobs = 0', '/jobs must be >= 1'],
    ['job = 2', ' must NOT have additional properties'],
    ['profile.real.retries = -1', '/profile/real/retries must be >= 0'],
    ['reports = ["pdf=x"]', '/reports/0 must match pattern'],
    ['param.1st = 1', '/param must match pattern'],
    ['fork = "sometimes"', '/fork must be equal to one of the allowed values'],
    ['timeouts.scale = 0', '/timeouts/scale must be > 0'],
    ['timeouts.run = true', '/timeouts/run must be string'],
    ['[[quarantine]]\nissue = "1"', "/quarantine/0 must have required property 'filter'"],
])('%s is invalid', (text, expected) => {
    expect(problems(text).join('\n')).toContain(expected);
});

test('the catalogue obeys the rules of SchemaStore', () => {
    const catalog = JSON.parse(read('editors/schemastore/catalog.json'));
    const names = catalog.schemas.map(({ name }: { name: string }) => name);
    expect(new Set(names).size).toBe(names.length);
    for (const entry of catalog.schemas) {
        expect(Object.keys(entry).sort()).toEqual(['description', 'fileMatch', 'name', 'url']);
        for (const text of [entry.name, entry.description]) {
            expect(text).not.toMatch(/schema|\n/i);
            expect(text).toBe(text.replace(/^[,.\s-]+|[,.\s-]+$/g, ''));
        }
        for (const match of entry.fileMatch) expect(match).not.toMatch(/^\/|\\|^\*+$/);
        expect(entry.url).toMatch(/^https:\/\//);
    }
});

test('the catalogues name files of this release', () => {
    const catalogs =
        read('editors/schemastore/catalog.json') + read('editors/schemastore/catalog.xml');
    const urls = [...catalogs.matchAll(/https:\/\/rtf\.example\.org\/releases\/([^/]+)\/([^"]+)/g)];
    const paths = urls.map(([, release, path = '']) => {
        expect(release).toBe(version);
        return path;
    });
    const files = [
        'schemas/config.json',
        'schemas/limits.json',
        'spec/suite.xsd',
        'spec/suite.xsd',
    ];
    expect(paths.sort()).toEqual(files);
    for (const path of paths) expect(existsSync(new URL(path, ROOT)), path).toBe(true);
});
