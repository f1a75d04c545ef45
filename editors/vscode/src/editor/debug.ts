// Attaches a debugger to the process of a test.

import * as vscode from 'vscode';
import { debuggerOf, waitingTest, type WaitingTest } from '../logic/debug';
import { Lines } from '../logic/lines';
import type { ItemData } from './tree';

/** Reads the standard error of `rtf run --debug-wait`, and attaches when the test waits. */
export class Attacher {
    private readonly lines = new Lines();

    constructor(
        private readonly run: vscode.TestRun,
        private readonly test: ItemData,
    ) {}

    read(piece: string): void {
        for (const line of this.lines.push(piece)) {
            const waiting = waitingTest(line);
            if (waiting !== undefined) void this.attach(waiting);
        }
    }

    private async attach({ pid, runner }: WaitingTest): Promise<void> {
        const { type = '', test = '', folder } = this.test;
        const found = debuggerOf(type, test, pid);
        if (found === undefined) {
            this.warn(
                `no debugger can attach to tests of type ${type}: use rtf run --debug in a terminal`,
            );
        } else if (vscode.extensions.getExtension(found.extension) === undefined) {
            this.warn(
                `debugging this test needs the extension ${found.extensionName} (${found.extension})`,
            );
        } else if (await vscode.debug.startDebugging(folder, found.configuration)) {
            return;
        }
        // Without a debugger, the test runs as usual.
        process.kill(runner, 'SIGUSR1');
    }

    private warn(text: string): void {
        this.run.appendOutput(`warning: ${text}\r\n`);
        void vscode.window.showWarningMessage(text);
    }
}
