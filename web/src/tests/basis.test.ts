import { expect, test } from 'vitest';
import type { FlakyTest } from '../generated/api';
import { basis, comparedText } from '../lib/history/basis';

test('pairs that are compared by equal sources are named', () => {
    const of = (pairs: number, pairs_by_sources?: number) =>
        basis({ pairs, pairs_by_sources } as FlakyTest);
    expect(of(3)).toBe('');
    expect(of(3, 3)).toBe('with equal sources');
    expect(of(3, 1)).toBe('(1 with equal sources)');
});

test('runs without a clean commit are counted', () => {
    expect(comparedText({ by_commit: 4, by_sources: 0, neither: 0 })).toEqual([]);
    const [first, second] = comparedText({ by_commit: 0, by_sources: 2, neither: 1 });
    expect(first).toMatch(/sources of a test are equal.*: 2 runs\.$/);
    expect(second).toMatch(/^Not compared with other runs, .*: 1 run\.$/);
});
