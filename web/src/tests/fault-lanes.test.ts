// The lanes of injected faults.

import { describe, expect, test } from 'vitest';
import { lanes } from '../lib/timeline';
import { recordOf, stream } from './streams';

describe('the timeline', () => {
    test('faults have a lane below their suite', () => {
        const faults = lanes(recordOf(stream('faults'))).filter(({ kind }) => kind === 'fault');
        expect(
            faults.map(({ row, bars }) => [
                row,
                bars.map(({ label, from, to }) => [label, from, to]),
            ]),
        ).toEqual([
            [
                0,
                [
                    ['drop-camera: stopped `camera.py` (process 4711)', 501_000, 1_002_000],
                    ['full: filled 512 MiB of `/data\u001b[31m`', 1_700_000, 1_870_000],
                ],
            ],
            [1, [['crash: killed `camera.py` (process 4711)', 1_800_000, 1_800_000]]],
        ]);
    });
});
