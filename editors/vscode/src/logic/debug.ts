// Debugging a test: `rtf run --debug-wait` starts it when a debugger has attached to its process
// (spec/debugging.md).

import { runCommand, type Selection } from './command';

/** The command line that debugs one test. */
export function debugCommand(selection: Selection, dir: string, args: readonly string[]): string[] {
    const [verb = 'run', ...rest] = runCommand([selection], dir, args);
    return [verb, '--debug-wait', ...rest];
}

/** A test that waits for a debugger. */
export interface WaitingTest {
    /** Its process. */
    pid: number;
    /** The runner, which starts the test without a debugger on SIGUSR1. */
    runner: number;
}

/** Returns the test that waits, if a line of standard error announces it. */
export function waitingTest(line: string): WaitingTest | undefined {
    const pattern = /^debug: process (\d+) waits for a debugger;.* kill -USR1 (\d+)$/;
    const announced = pattern.exec(line);
    if (announced === null) return undefined;
    return { pid: Number(announced[1]), runner: Number(announced[2]) };
}

/** The debugger of a test: the extension that provides it, and how it attaches, as in launch.json;
 *  nothing if no debugger can attach to tests of this type. */
export function debuggerOf(type: string, test: string, pid: number) {
    const attach = { request: 'attach', name: `rtf: ${test}`, processId: pid } as const;
    if (type === 'python') {
        return {
            extension: 'ms-python.debugpy',
            extensionName: 'Python Debugger',
            configuration: { ...attach, type: 'debugpy', justMyCode: false },
        };
    }
    // Plug-ins in C, C++ and Ada.
    if (type !== 'dll') return undefined;
    return {
        extension: 'ms-vscode.cpptools',
        extensionName: 'C/C++',
        configuration: {
            ...attach,
            type: 'cppdbg',
            program: `/proc/${pid}/exe`,
            MIMode: 'gdb',
            // The plug-in is not loaded yet.
            setupCommands: [{ text: 'set breakpoint pending on', ignoreFailures: false }],
        },
    };
}
