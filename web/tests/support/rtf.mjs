// Runs the real rtf, whose page is then looked at.

import { spawn } from 'node:child_process';
import { mkdtemp, readdir, rm, writeFile, cp } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const TOP = fileURLToPath(new URL('../../../', import.meta.url));
const RTF = process.env['RTF'] ?? path.join(TOP, 'target/release/rtf');
const PLUGINS = fileURLToPath(new URL('../plugins/', import.meta.url));
const PATIENCE_MS = 60_000;

/** A temporary folder with the plug-ins, in which suites are run. */
export class Bench {
    /** Programs that were started and have to be gone at the end. */
    children = new Set();

    static async make() {
        const bench = new Bench();
        bench.folder = await mkdtemp(path.join(tmpdir(), 'rtf-page-'));
        await cp(PLUGINS, bench.folder, { recursive: true });
        return bench;
    }

    /** Lets whatever waits for this word go on. */
    async open(...words) {
        for (const word of words) await writeFile(path.join(this.folder, `${word}.go`), '');
    }

    async write(name, content) {
        await writeFile(path.join(this.folder, name), content);
    }

    /** `rtf run --web` of a suite; resolves when its page can be opened. */
    async run(suite, ...options) {
        await this.write('suite.xml', suite);
        return this.start(['run', '--web=127.0.0.1:0', ...options, 'suite.xml']);
    }

    /** `rtf serve` of all runs so far. */
    serve(...options) {
        return this.start(['serve', '--web=127.0.0.1:0', ...options]);
    }

    /** A run that nobody looks at. */
    async runToEnd(suite) {
        await this.write('suite.xml', suite);
        const program = this.spawn(['run', 'suite.xml']);
        await program.ended;
    }

    async names() {
        const names = await readdir(path.join(this.folder, 'rtf-results'));
        return names.filter((name) => name !== 'latest').sort();
    }

    async start(args) {
        const program = this.spawn(args);
        program.url = await within(`the address of rtf ${args[0]}`, program.address);
        program.origin = new URL(program.url).origin;
        program.token = new URL(program.url).hash.replace('#token=', '');
        return program;
    }

    spawn(args) {
        const child = spawn(RTF, args, {
            cwd: this.folder,
            stdio: ['ignore', 'pipe', 'pipe'],
            env: { ...process.env, NO_COLOR: '1', PAGE_TEST_FOLDER: this.folder },
        });
        const program = { child, printed: '' };
        program.address = new Promise((resolve, reject) => {
            const read = (text) => {
                program.printed += text;
                const found = /https?:\/\/\S+/.exec(program.printed);
                if (found !== null) resolve(found[0]);
            };
            for (const stream of [child.stdout, child.stderr])
                stream.setEncoding('utf8').on('data', read);
            child.on('error', reject);
            child.on('exit', (code) =>
                reject(new Error(`rtf ended with ${code}: ${program.printed}`)),
            );
        });
        // Whoever wants the address asks for it.
        program.address.catch(() => undefined);
        program.ended = new Promise((resolve) => child.on('exit', (code) => resolve(code)));
        this.children.add(program);
        return program;
    }

    /** Ends what still runs, as a user would, and removes the folder. */
    async close() {
        for (const { child, ended } of this.children) {
            if (child.exitCode === null && child.signalCode === null) child.kill('SIGINT');
            await within('the end of rtf', ended);
        }
        await rm(this.folder, { recursive: true });
    }
}

/** Fails when something takes far longer than it should. */
export function within(what, promise) {
    let timer;
    const late = new Promise((_, reject) => {
        timer = setTimeout(
            () => reject(new Error(`${what}: not in ${PATIENCE_MS} ms`)),
            PATIENCE_MS,
        );
    });
    return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

/** A part of a test that builds on those before it: the first that fails is the last. */
export async function step(name, work) {
    try {
        await work();
    } catch (problem) {
        throw new Error(`${name}: ${problem.message}`, { cause: problem });
    }
}
