import { describe, expect, test } from 'vitest';
import type { Snapshot } from '../lib/api-types';
import { emptySnapshot, RunRecord } from '../lib/record/record';
import { marks, spans, valueText } from '../lib/record/fixture';
import { isFlaky } from '../lib/record/test';
import { names, recordOf, stream } from './streams';

/** A summary of a run: its result, then each test. */
function told(record: RunRecord): string[] {
    const { state, green } = record.info;
    return [
        `${state} ${green ? 'green' : 'not green'}`,
        ...record.tests.map((each) => `${each.name}: ${record.stateOf(each)}`),
        ...record.suites.flatMap((suite) => record.suiteProblems(suite)),
        ...record.fixtures.flatMap(({ name, values = [] }) =>
            values.map((value) => `${name}.${value.name} = ${valueText(value)}`),
        ),
    ];
}

describe('the fold over the stored streams', () => {
    test.each(names())('%s', (name) => {
        expect(told(recordOf(stream(name)))).toMatchSnapshot();
    });

    test.each(names())('%s ends the same from a snapshot at any moment', (name) => {
        const events = stream(name);
        const whole = told(recordOf(events));
        const data = emptySnapshot();
        const grown = new RunRecord(data);
        for (const event of events) {
            grown.apply(event);
            // A page that opens now gets a snapshot, then the same events and the rest.
            const opened = new RunRecord(structuredClone(data) as Snapshot);
            for (const each of events) opened.apply(each);
            expect(told(opened)).toEqual(whole);
        }
    });
});

test('each test of the plan is known before it runs', () => {
    const record = recordOf(stream('verdicts').filter(({ type }) => type.endsWith('planned')));
    const { planned, pending, done } = record.totals();
    expect([planned, pending, done]).toEqual([8, 8, 0]);
});

test('the private resources of a suite are kept from its first event', () => {
    const events = stream('prepared');
    const record = recordOf(events);
    const prepared = record.suites[0]?.prepared;
    expect(prepared?.ports?.map(({ name }) => name)).toEqual([
        'gazebo-master',
        'ros-master',
        'sim',
    ]);
    expect(prepared?.network).toEqual({ pid: 4711, user_namespace: true });
    expect(prepared).not.toHaveProperty('type');
    const told = events.find(({ type }) => type === 'suite-prepared');
    if (told?.type !== 'suite-prepared') throw new Error('the stream tells it');
    record.apply({ ...told, seq: record.info.seq, join_command: 'another' });
    expect(record.suites[0]?.prepared).toBe(prepared);
});

test('a fixture that collapses is a lane with its marks', () => {
    const [fixture] = recordOf(stream('collapse-restart')).fixtures;
    if (fixture === undefined) throw new Error('the stream has a fixture');
    expect(spans(fixture).map(({ state }) => state)).toEqual([
        'starting',
        'ready',
        'collapsed',
        'stopping',
        'starting',
        'ready',
        'stopping',
    ]);
    expect(spans(fixture).every(({ to }) => to !== null)).toBe(true);
    expect(marks(fixture).map(({ kind }) => kind)).toEqual(['collapsed', 'restarted']);
});

test('a fixture has the values of its last start', () => {
    const record = new RunRecord();
    const seen: unknown[] = [];
    for (const event of stream('values')) {
        record.apply(event);
        if (event.type === 'fixture-starting' || event.type === 'fixture-ready')
            seen.push(record.fixtures[event.fixture]?.values);
    }
    const device = { name: 'device', value: '/dev/ttyUSB0' };
    const token = { name: 'token', secret: true };
    expect(seen.slice(0, 4)).toEqual([
        undefined,
        [{ name: 'port', value: '40123' }, device],
        undefined,
        [token],
    ]);
    expect(seen.slice(4, 7)).toEqual([
        undefined,
        [{ name: 'port', value: '40987' }, device],
        undefined,
    ]);
    const [, arm] = record.fixtures;
    const texts = arm?.values?.map((each) => valueText(each)) ?? [];
    expect(texts.slice(0, 2)).toEqual(['***', '[-1.5,2,{"joint":"elbow"}]']);
    expect(texts.slice(3, 6)).toEqual(['', 'true', '12.5']);
});

test('a test that passes after a retry is flaky', () => {
    const record = recordOf(stream('collapse-restart'));
    expect(record.tests.map(isFlaky)).toEqual([true, false]);
});

test('a known event changes nothing', () => {
    const events = stream('repetitions');
    const record = recordOf(events);
    const before = JSON.stringify(record.tests);
    for (const event of events) record.apply(event);
    expect(JSON.stringify(record.tests)).toBe(before);
});

test('progress without events moves the position where the stream resumes', () => {
    const record = recordOf(stream('measured').slice(0, 8));
    record.progress(41, 9_000_000);
    expect([record.info.seq, record.info.last_at]).toEqual([42, 9_000_000]);
    record.progress(3, 5);
    expect([record.info.seq, record.info.last_at]).toEqual([42, 9_000_000]);
});
