// The answers of a report, in place of the server's.

import { describe, expect, test } from 'vitest';
import { path } from '../lib/api';
import { Answers } from '../lib/report/answers';
import type { Data } from '../lib/report/embedded';

const RUN = 'a run/1';
const TESTS = [
    { id: 0, attempts: [{ number: 1 }] },
    { id: 1, attempts: [{ number: 1 }] },
];
const BLOCKS: Record<string, unknown> = {
    overview: {
        format: 1,
        run: RUN,
        snapshot: { info: { run: RUN, rtf: '0.1.0' }, tests: TESTS },
        places: { 'tests/0': 0, 'tests/0/1': 1, 'tests/1/1': 1 },
    },
    0: { 'tests/0': { test: TESTS[0], attempts: [] } },
    1: {
        'tests/0/1': {
            messages: [{ seq: 1 }],
            omitted: { messages: 7 },
            series: [{ name: 'elbow', times: [0, 1, 2], values: [5, 6, 7] }],
            cases: { cases: [{ path: 'Arm/Moves home' }] },
        },
        'tests/1/1': { cases: { cases: [{ path: 'Arm' }, { path: 'home' }] } },
    },
};

class Blocks implements Data {
    readonly names: string[] = [];

    constructor(private readonly blocks = BLOCKS) {}

    readBlock<T>(name: string): Promise<T> {
        this.names.push(name);
        return Promise.resolve(this.blocks[name] as T);
    }
}

const part = (...parts: (string | number)[]) => path(['runs', RUN, ...parts]);

describe('a report responds as the server does', async () => {
    const data = new Blocks();
    const { get } = await Answers.open(data);

    test('it is a server without control, and has one run', async () => {
        expect(await get('')).toMatchObject({ mode: 'report', current: RUN, control: false });
        expect(await get('/runs?limit=20')).toEqual({ runs: [{ run: RUN, rtf: '0.1.0' }] });
        expect(await get(part('snapshot'))).toMatchObject({ tests: TESTS });
        expect(data.names, 'no details are read').toEqual(['overview']);
    });

    test('details are found by their keys', async () => {
        const details = ['tests', 0, 'attempts', 1];
        expect(await get(part('tests', 0))).toEqual({ test: TESTS[0], attempts: [] });
        expect(await get(part(...details, 'messages'))).toEqual({
            messages: [{ seq: 1 }],
            omitted: 7,
        });
        expect(await get(part(...details, 'output'))).toEqual({ output: [] });
        expect(await get(part('tests', 9, 'attempts', 1, 'cases'))).toEqual({ cases: [] });
        expect(await get(part('fixtures', 0, 'starts', 1, 'messages'))).toEqual({ messages: [] });
    });

    test('a part of a signal', async () => {
        const series = part('tests', 0, 'attempts', 1, 'series');
        expect(await get(`${series}?from=0.5&to=1.5`)).toMatchObject({
            series: [{ name: 'elbow', times: [1], values: [6] }],
        });
        expect(await get(series)).toMatchObject({ series: [{ times: [0, 1, 2] }] });
    });

    test('tests are found by words in the path of one case', async () => {
        expect(await get(`${part('tests')}?case=HOME%20arm&limit=1000`)).toEqual({
            tests: [TESTS[0]],
        });
    });

    test('there is nothing else', async () => {
        for (const unknown of ['/runs/another/snapshot', part('journal'), part('tests', 1)])
            await expect(get(unknown)).rejects.toMatchObject({ status: 404 });
    });
});

test('data of another format is refused', async () => {
    const data = new Blocks({ overview: { format: 2 } });
    await expect(Answers.open(data)).rejects.toThrow('unknown format 2');
});
