import { describe, expect, test } from 'vitest';
import { SseParser } from '../lib/live/sse';
import { addToLists, append, emptyLists } from '../lib/record/detail';
import { stream } from './streams';

describe('server-sent events', () => {
    const text =
        ': heartbeat\n\nid: 1\ndata: {"seq":1}\n\nevent: resync\r\nid: 8\r\ndata: {"from":9}\r\n\r\n' +
        'data: two\ndata: lines\n\nid: 9\n\n';
    const whole = [
        { type: 'message', id: '1', data: '{"seq":1}' },
        { type: 'resync', id: '8', data: '{"from":9}' },
        { type: 'message', id: '8', data: 'two\nlines' },
    ];

    test.each([1, 2, 3, 7, 1000])('in pieces of %i', (length) => {
        const parser = new SseParser();
        const events = [];
        for (let at = 0; at < text.length; at += length) {
            events.push(...parser.push(text.slice(at, at + length)));
        }
        expect(events).toEqual(whole);
    });

    test('an incomplete event is not delivered', () => {
        expect(new SseParser().push('id: 1\ndata: half')).toEqual([]);
    });
});

test('an entry in both pages and events is kept once', () => {
    const events = stream('measured').filter(({ type }) => type === 'measured');
    const lists = emptyLists();
    for (const event of [...events, ...events]) addToLists(lists, event, 'run');
    expect(lists.measurements.map(({ seq, within }) => [seq, within])).toEqual([
        [8, true],
        [16, false],
    ]);
    append(lists.measurements, { ...lists.measurements[0]! });
    expect(lists.measurements).toHaveLength(2);
});

test('the address of an attachment is encoded', () => {
    const lists = emptyLists();
    for (const event of stream('nasty')) addToLists(lists, event, 'a/b');
    expect(lists.attachments[0]?.url).toBe('/api/v1/runs/a%2Fb/files/attachments/%3C%26%3E%1B.bin');
});
