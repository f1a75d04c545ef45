import { expect, test } from 'vitest';
import { parseList } from './list';

test('tests and their cases are read', () => {
    const text = JSON.stringify({
        tests: [
            {
                suite: 'arm',
                name: 'Reach',
                select: 'arm.xml::Reach',
                file: 'arm.xml',
                line: 3,
                type: 'gtest',
                plugin: '/build/reach_test',
                tags: ['slow'],
                cases: [
                    { name: 'Arm.Moves', location: { file: 'arm_test.cpp', line: 12 } },
                    { name: 'Arm.DISABLED_Rests', disabled: true },
                ],
            },
        ],
    });
    expect(parseList(text)).toEqual([
        {
            suite: 'arm',
            name: 'Reach',
            line: 3,
            type: 'gtest',
            plugin: '/build/reach_test',
            tags: ['slow'],
            cases: [
                { name: 'Arm.Moves', location: { file: 'arm_test.cpp', line: 12 } },
                { name: 'Arm.DISABLED_Rests', disabled: true },
            ],
        },
    ]);
});

test('other text is refused', () => {
    expect(() => parseList('error: no such file')).toThrow();
    expect(() => parseList('{}')).toThrow('no list of tests');
    expect(() => parseList('{"tests":[{}]}')).toThrow('no list of tests');
});
