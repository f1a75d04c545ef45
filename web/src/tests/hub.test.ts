// One stream for all followers of a run.

import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { Hub, type Request, type StreamOptions } from '../lib/live/hub';
import type { SseEvent, StreamEnd } from '../lib/live/sse';

interface Opened extends Request, StreamOptions {
    end: (end: StreamEnd) => void;
}

let opened: Opened[];
let hub: Hub;

beforeEach(() => {
    vi.useFakeTimers();
    opened = [];
    hub = new Hub(
        (request, options) => new Promise((end) => opened.push({ ...request, ...options, end })),
    );
});
afterEach(() => vi.useRealTimers());

function join(from: number, details: string[] = [], run = 'run') {
    const seen: string[] = [];
    const leave = hub.subscribe(run, {
        from,
        details,
        opened: () => seen.push('opened'),
        received: (events) => seen.push(...events.map(({ id }) => id)),
        ended: (end) => seen.push('lost' in end ? 'lost' : `${end.status}`),
    });
    return { seen, leave };
}

const event = (id: number): SseEvent => ({ type: 'message', id: `${id}`, data: '{}' });
const soon = () => vi.advanceTimersByTimeAsync(20);
const running = () => opened.filter(({ signal }) => !signal.aborted);

test('ten tabs share one stream, from the position of the slowest', async () => {
    const tabs = Array.from({ length: 10 }, (_, index) => join(100 - index));
    await soon();
    expect(opened.map(({ from, details }) => [from, details])).toEqual([[91, []]]);
    opened[0]?.opened();
    opened[0]?.received([event(100), event(101)]);
    expect(tabs.map(({ seen }) => seen)).toEqual(Array(10).fill(['opened', '100', '101']));
    tabs.slice(1).forEach(({ leave }) => leave());
    await soon();
    expect(running()).toHaveLength(1);
    tabs[0]?.leave();
    expect(running()).toHaveLength(0);
});

test('a late follower misses nothing, and the others are not set back', async () => {
    const first = join(5);
    await soon();
    opened[0]?.opened();
    opened[0]?.received([event(5), event(6)]);
    const behind = join(3);
    await soon();
    expect(opened[0]?.signal.aborted).toBe(true);
    expect(opened[1]?.from).toBe(3);
    opened[1]?.opened();
    const ahead = join(9);
    await soon();
    expect(opened).toHaveLength(2);
    expect(ahead.seen).toEqual(['opened']);
    // The hub ignores what the first stream still delivers.
    opened[0]?.received([event(7)]);
    opened[1]?.received([event(7)]);
    expect(first.seen).toEqual(['opened', '5', '6', 'opened', '7']);
    expect(behind.seen).toEqual(['opened', '7']);
});

test('details are requested as long as a follower needs them', async () => {
    const one = join(0, ['test:3']);
    const other = join(0, ['fixture:0', 'test:3']);
    await soon();
    expect(opened[0]?.details).toEqual(['fixture:0', 'test:3']);
    opened[0]?.opened();
    other.leave();
    await soon();
    expect(opened[1]?.details).toEqual(['test:3']);
    one.leave();
    expect(running()).toHaveLength(0);
});

test('the end of the stream is reported to all followers, which restart separately', async () => {
    const tabs = [join(0), join(1)];
    await soon();
    opened[0]?.opened();
    opened[0]?.end({ lost: true });
    await soon();
    expect(tabs.map(({ seen }) => seen)).toEqual(Array(2).fill(['opened', 'lost']));
    expect(opened).toHaveLength(1);
    join(7);
    await soon();
    expect(opened[1]?.from).toBe(7);
});

test('each run has its own stream', async () => {
    join(0, [], 'one');
    join(0, [], 'other');
    await soon();
    expect(opened.map(({ run }) => run)).toEqual(['one', 'other']);
});
