// Runs the real rtf, which serves the page.

import { spawn } from 'node:child_process';
import { mkdir, mkdtemp, readdir, rm, writeFile, cp } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const TOP = fileURLToPath(new URL('../../../', import.meta.url));
const RTF = process.env['RTF'] ?? path.join(TOP, 'target/release/rtf');
const PLUGINS = fileURLToPath(new URL('../plugins/', import.meta.url));
const PATIENCE_MS = 60_000;

/** A temporary directory with the plug-ins, in which suites run. */
export class Bench {
    /** Started programs, which must have exited at the end. */
    children = new Set();

    static async make() {
        const bench = new Bench();
        bench.dir = await mkdtemp(path.join(tmpdir(), 'rtf-page-'));
        await cp(PLUGINS, bench.dir, { recursive: true });
        return bench;
    }

    /** Lets plug-ins that wait for this word continue. */
    async open(...words) {
        for (const word of words) await writeFile(path.join(this.dir, `${word}.go`), '');
    }

    async write(name, content) {
        await writeFile(path.join(this.dir, name), content);
    }

    /** `rtf run --web` of a suite; resolves when its server is ready. */
    async run(suite, ...options) {
        await this.write('suite.xml', suite);
        return this.start(['run', '--web=127.0.0.1:0', ...options, 'suite.xml']);
    }

    /** `rtf serve` of all runs so far. */
    serve(...options) {
        return this.start(['serve', '--web=127.0.0.1:0', ...options]);
    }

    /** A run without a page. */
    async runToEnd(suite, ...options) {
        await this.write('suite.xml', suite);
        const program = this.spawn(['run', ...options, 'suite.xml']);
        await program.ended;
    }

    /** Writes the HTML report of a run; returns its address. */
    async report(run, file = 'report.html') {
        const program = this.spawn(['report', run, '--format', 'html', '-o', file]);
        const code = await within('the report', program.ended);
        if (code !== 0) throw new Error(`rtf report ended with ${code}: ${program.printed}`);
        return this.fileUrl(file);
    }

    fileUrl(file) {
        return pathToFileURL(path.join(this.dir, file)).href;
    }

    /** A finished run with these events, numbered here. */
    async journal(name, events) {
        const dir = path.join(this.dir, 'rtf-results', name);
        await mkdir(dir, { recursive: true });
        const lines = events.map((event, seq) => JSON.stringify({ seq, at: seq * 1000, ...event }));
        await writeFile(path.join(dir, 'events.jsonl'), `${lines.join('\n')}\n`);
    }

    async names() {
        const entries = await readdir(path.join(this.dir, 'rtf-results'), { withFileTypes: true });
        return entries
            .filter((entry) => entry.isDirectory())
            .map((entry) => entry.name)
            .sort();
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
            cwd: this.dir,
            stdio: ['ignore', 'pipe', 'pipe'],
            env: { ...process.env, NO_COLOR: '1', PAGE_TEST_DIR: this.dir },
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
        // A caller that needs the address awaits it.
        program.address.catch(() => undefined);
        program.ended = new Promise((resolve) => child.on('exit', (code) => resolve(code)));
        this.children.add(program);
        return program;
    }

    /** Interrupts running programs, as a user would, and removes the directory. */
    async close() {
        for (const { child, ended } of this.children) {
            if (child.exitCode === null && child.signalCode === null) child.kill('SIGINT');
            await within('the end of rtf', ended);
        }
        await rm(this.dir, { recursive: true });
    }
}

/** Fails when something takes far too long. */
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

/** A step of a test that depends on the previous steps. */
export async function step(name, work) {
    try {
        await work();
    } catch (problem) {
        throw new Error(`${name}: ${problem.message}`, { cause: problem });
    }
}
