import { describe, expect, it } from 'vitest';
import type { AttachmentEntry, Signal } from '../lib/api-types';
import { grouped } from '../lib/pictures';
import { tubeOf, violatedSignals, withoutTubes } from '../lib/signals';

function signal(name: string, unit = 'rad'): Signal {
    return { name, unit, count: 0, outside: 0, times: [], values: [] };
}

const names = (signals: readonly Signal[]) => signals.map(({ name }) => name);

describe('sides of tubes', () => {
    const all = [
        signal('a/b'),
        signal('trajectory/a/b/low'),
        signal('trajectory/a/b/high'),
        signal('trajectory/a/b#2/low'),
        signal('trajectory/c/low'),
        signal('trajectory/a/b/high', 'deg'),
    ];

    it('belong to the signal in their name', () => {
        expect(names(tubeOf(all[0]!, all))).toEqual([
            'trajectory/a/b/low',
            'trajectory/a/b/high',
            'trajectory/a/b#2/low',
        ]);
    });

    it('are signals of their own without it, or with another unit', () => {
        expect(withoutTubes(all)).toEqual([all[0], all[4], all[5]]);
    });
});

describe('signals of violated monitors', () => {
    it('are those that a violation names, without sides of tubes', () => {
        const all = [signal('a'), signal('trajectory/a/low'), signal('b')];
        const violation = { start: 0, end: 1, signals: ['a', 'trajectory/a/low', 'x'], text: '' };
        expect(names(violatedSignals(all, [violation]))).toEqual(['a']);
        expect(violatedSignals(all, [])).toEqual([]);
    });
});

describe('compared pictures', () => {
    const picture = { reference: 'golden/a.png', tolerance: 0 };
    const entry = (path: string, isCompared = false): AttachmentEntry => ({
        seq: 0,
        at: 0,
        url: path,
        attachment: { name: path, path, ...(isCompared ? { picture } : {}) },
    });
    const paths = (entries: readonly AttachmentEntry[]) =>
        grouped(entries).map((group) => group.map(({ url }) => url));

    it('are grouped with their reference and the difference', () => {
        expect(
            paths([
                entry('d/1-a.png', true),
                entry('d/1-a-reference.jpg'),
                entry('d/1-a-difference.png'),
                entry('d/2-a.png', true),
                entry('d/3-a.png'),
            ]),
        ).toEqual([
            ['d/1-a.png', 'd/1-a-reference.jpg', 'd/1-a-difference.png'],
            ['d/2-a.png'],
            ['d/3-a.png'],
        ]);
    });

    it('are no other files with such names', () => {
        expect(paths([entry('d/a.png'), entry('d/a-reference.png')])).toHaveLength(2);
    });
});
