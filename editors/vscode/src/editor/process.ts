// Starts rtf.

import { type ChildProcess, spawn } from 'node:child_process';

/** How a process ended. */
export interface Exit {
    code: number | null;
    signal: string | null;
    /** Its standard error. */
    errors: string;
}

export interface Started {
    process: ChildProcess;
    exit: Promise<Exit>;
}

/** Receives what a program writes, in pieces. */
export interface Readers {
    onOutput(piece: string): void;
    onErrors?(piece: string): void;
}

/** Starts a program.
 *
 *  Its standard input stays open: with `--end-with-stdin`, a run ends when the editor does. */
export function start(
    program: string,
    args: readonly string[],
    dir: string,
    readers: Readers,
): Started {
    const process = spawn(program, args, { cwd: dir, stdio: ['pipe', 'pipe', 'pipe'] });
    let errors = '';
    process.stdout.setEncoding('utf8').on('data', (piece: string) => readers.onOutput(piece));
    process.stderr.setEncoding('utf8').on('data', (piece: string) => {
        errors += piece;
        readers.onErrors?.(piece);
    });
    // The process may end before its input is closed.
    process.stdin.on('error', () => undefined);
    const exit = new Promise<Exit>((resolve) => {
        process.on('error', (error) => {
            const errors = `cannot start ${program}: ${error.message}`;
            resolve({ code: null, signal: null, errors });
        });
        process.on('close', (code, signal) => resolve({ code, signal, errors }));
    });
    return { process, exit };
}
