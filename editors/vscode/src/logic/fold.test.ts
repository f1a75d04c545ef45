// Feeds recorded event streams of rtf through the fold: those over which the reporters of
// rtf-report are tested, too.

import { readdirSync, readFileSync } from 'node:fs';
import { describe, expect, test } from 'vitest';
import { parseEvent, REQUIRED_FIELDS } from './events';
import { RunFold } from './fold';
import type { Update } from './updates';

const ROOT = new URL('../../../../', import.meta.url);
const STREAMS = new URL('crates/rtf-report/tests/streams/', ROOT);

function lines(stream: string): string[] {
    return readFileSync(new URL(`${stream}.jsonl`, STREAMS), 'utf8').split('\n');
}

function updates(stream: string): Update[] {
    const fold = new RunFold();
    const during = lines(stream).flatMap((line) => {
        const event = parseEvent(line);
        return event === undefined ? [] : fold.apply(event);
    });
    return [...during, ...fold.end('rtf ended during the test')];
}

function name({ target }: Update): string {
    return [target?.test ?? '(suite)', ...(target?.cases ?? [])].join('/');
}

/** The outcomes: `Reach failed: stuck at joint 3 @Reach.lua:3`. */
function outcomes(stream: string): string[] {
    return updates(stream).flatMap((update) => {
        if (update.kind !== 'finished') return [];
        const problems = update.problems.map(({ text, location }) => {
            const at = location === undefined ? '' : ` @${location.file}:${location.line}`;
            return `${text.split('\n')[0]}${at}`;
        });
        return [[`${name(update)} ${update.outcome}`, ...problems].join(' | ')];
    });
}

const ALL = readdirSync(STREAMS)
    .filter((file) => file.endsWith('.jsonl'))
    .map((file) => file.replace('.jsonl', ''));

describe('every recorded run', () => {
    test.each(ALL)('%s', (stream) => {
        const open = new Set<string>();
        for (const update of updates(stream)) {
            if (update.kind === 'output') continue;
            if (update.kind === 'started') open.add(`${update.target.file} ${name(update)}`);
            else open.delete(`${update.target.file} ${name(update)}`);
        }
        // What starts also finishes; cases that a killed runner left open have no event.
        expect([...open].filter((each) => !each.includes('/'))).toEqual([]);
        expect(outcomes(stream)).toMatchSnapshot();
    });
});

test('output is shown at its test, that of fixtures at the run', () => {
    const texts = updates('collapse-restart').flatMap((update) =>
        update.kind === 'output' ? [`${update.target?.test ?? '-'}: ${update.text}`] : [],
    );
    expect(texts).toMatchSnapshot();
});

test('cases have the position of their source', () => {
    const cases = updates('cases').flatMap((update) =>
        update.kind === 'started' && update.target.cases !== undefined
            ? [[name(update), update.location]]
            : [],
    );
    expect(cases).toMatchSnapshot();
});

test('the schema of events has all fields that the extension reads', () => {
    const schema = JSON.parse(readFileSync(new URL('schemas/event.json', ROOT), 'utf8'));
    const kinds = new Map<string, object>();
    const collect = (node: unknown): void => {
        if (typeof node !== 'object' || node === null) return;
        const { properties, $ref } = node as {
            properties?: Record<string, { const?: string }>;
            $ref?: string;
        };
        const type = properties?.['type']?.const;
        if (properties !== undefined && type !== undefined) {
            const target = $ref === undefined ? {} : schema.$defs[$ref.split('/').at(-1) ?? ''];
            kinds.set(type, { ...properties, ...target.properties });
        }
        Object.values(node).forEach(collect);
    };
    collect(schema);
    for (const [type, fields] of Object.entries(REQUIRED_FIELDS)) {
        for (const field of fields) {
            expect(Object.keys(kinds.get(type) ?? {}), type).toContain(field);
        }
    }
});
