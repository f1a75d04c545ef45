import { expect, test } from 'vitest';
import { debugCommand, debuggerOf, waitingTest } from './debug';

test('one test is debugged', () => {
    const selection = { file: '/ws/arm.xml', test: 'Reach' };
    expect(debugCommand(selection, '/ws', ['--profile', 'sim']).join(' ')).toBe(
        'run --debug-wait --format json --end-with-stdin --profile sim arm.xml::Reach',
    );
});

test('the process that waits is announced', () => {
    const line =
        'debug: process 4711 waits for a debugger; to start the test without one: kill -USR1 4700';
    expect(waitingTest(line)).toEqual({ pid: 4711, runner: 4700 });
    expect(waitingTest('debug: process 4711 has the terminal')).toBeUndefined();
});

test('the debugger depends on the type of the test', () => {
    expect(debuggerOf('dll', 'Reach', 4711)?.configuration).toMatchObject({
        type: 'cppdbg',
        request: 'attach',
        processId: 4711,
        program: '/proc/4711/exe',
    });
    expect(debuggerOf('python', 'Reach', 4711)?.configuration).toMatchObject({
        type: 'debugpy',
        request: 'attach',
        processId: 4711,
    });
    expect(debuggerOf('lua', 'Reach', 4711)).toBeUndefined();
});
