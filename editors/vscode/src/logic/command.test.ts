import { expect, test } from 'vitest';
import { expandVariables, listCommand, planArguments, runCommand, selector } from './command';

test.each([
    [{ file: '/ws/suites/arm.xml' }, 'suites/arm.xml'],
    [{ file: '/ws/arm.xml', test: 'Move[joint=0]' }, 'arm.xml::Move[joint=0]'],
    [{ file: '/ws/arm.xml', test: 'Reach', cases: ['left', 'high'] }, 'arm.xml::Reach/left/high'],
    [{ file: '/ws/-arm.xml' }, './-arm.xml'],
    [{ file: '/elsewhere/arm.xml' }, '/elsewhere/arm.xml'],
])('%o is selected by %s', (selection, expected) => {
    expect(selector(selection, '/ws')).toBe(expected);
});

test('only arguments that change the plan apply when tests are listed', () => {
    const args = ['--profile', 'sim', '--jobs', '2', '--set=a=1', '--set', 'b=2', '-v'];
    expect(planArguments(args)).toEqual(['--profile', 'sim', '--set=a=1', '--set', 'b=2']);
    expect(planArguments(['--retries', '--profile'])).toEqual(['--profile']);
});

test('command lines', () => {
    expect(listCommand('/ws/arm.xml', '/ws', ['--profile', 'sim', '--jobs', '2'])).toEqual([
        'list',
        '--format',
        'json',
        '--profile',
        'sim',
        'arm.xml',
    ]);
    const selections = [{ file: '/ws/arm.xml', test: 'Reach' }, { file: '/ws/hand.xml' }];
    expect(runCommand(selections, '/ws', ['--jobs', '2'])).toEqual([
        'run',
        '--format',
        'json',
        '--end-with-stdin',
        '--jobs',
        '2',
        'arm.xml::Reach',
        'hand.xml',
    ]);
});

test('variables in settings', () => {
    expect(expandVariables('${workspaceFolder}/bin/rtf', '/ws')).toBe('/ws/bin/rtf');
});
