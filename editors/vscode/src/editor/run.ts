// Runs what is selected in the Test Explorer, and shows results as they arrive.

import { resolve } from 'node:path';
import * as vscode from 'vscode';
import { runCommand } from '../logic/command';
import { debugCommand } from '../logic/debug';
import { parseEvent } from '../logic/events';
import { RunFold } from '../logic/fold';
import { Lines } from '../logic/lines';
import type { Location } from '../logic/list';
import { nodesToRun } from '../logic/selection';
import { type NextRequest, REQUEST_MS, StopRequests } from '../logic/stop';
import type { Problem, Target, Update } from '../logic/updates';
import { Attacher } from './debug';
import { type Exit, type Started, start } from './process';
import { settingsOf } from './settings';
import { type ItemData, items, type Tree } from './tree';

/** Runs or debugs a request of the Test Explorer. */
export async function runTests(
    tree: Tree,
    request: vscode.TestRunRequest,
    token: vscode.CancellationToken,
    log: vscode.LogOutputChannel,
): Promise<void> {
    const isDebugged = request.profile?.kind === vscode.TestRunProfileKind.Debug;
    const run = tree.controller.createTestRun(request);
    try {
        const selected = await select(tree, request);
        // rtf debugs one test at a time.
        const groups = isDebugged ? selected.map((item) => [item]) : byFolder(tree, selected);
        for (const chosen of groups) {
            if (token.isCancellationRequested) break;
            await new RtfRun({ tree, run, chosen, log, isDebugged }).finish(token);
        }
    } finally {
        run.end();
    }
}

/** Returns the items to run. Suites whose tests are unknown are listed before. */
export async function select(
    tree: Tree,
    request: vscode.TestRunRequest,
): Promise<vscode.TestItem[]> {
    const included = request.include ?? items(tree.controller.items);
    const unlisted = included.filter(
        (item) => item.parent === undefined && item.children.size === 0,
    );
    await Promise.all(unlisted.map((item) => tree.list(item)));
    return nodesToRun(included, request.exclude ?? [], (item) => items(item.children));
}

/** Groups items by workspace folder, in which rtf is started. */
function byFolder(tree: Tree, selected: readonly vscode.TestItem[]): vscode.TestItem[][] {
    const groups = new Map<vscode.WorkspaceFolder, vscode.TestItem[]>();
    for (const item of selected) {
        const { folder } = tree.selection(item);
        groups.set(folder, [...(groups.get(folder) ?? []), item]);
    }
    return [...groups.values()];
}

interface RunContext {
    tree: Tree;
    run: vscode.TestRun;
    /** Items of one folder, at least one. */
    chosen: readonly vscode.TestItem[];
    log: vscode.LogOutputChannel;
    isDebugged: boolean;
}

/** One process of `rtf run`. */
class RtfRun {
    private readonly fold = new RunFold();
    private readonly lines = new Lines();
    private readonly dir: string;
    private readonly started: Started;

    constructor(private readonly context: RunContext) {
        const { tree, run, chosen, log, isDebugged } = context;
        const selections = chosen.map((item) => tree.selection(item));
        const first = selections[0] as ItemData;
        const settings = settingsOf(first.folder);
        this.dir = first.folder.uri.fsPath;
        const args = isDebugged
            ? debugCommand(first, this.dir, settings.arguments)
            : runCommand(selections, this.dir, settings.arguments);
        log.info([settings.path, ...args].join(' '));
        chosen.forEach((item) => this.enqueue(item));
        const attacher = new Attacher(run, first);
        this.started = start(settings.path, args, this.dir, {
            onOutput: (piece) => this.read(piece),
            onErrors: (piece) => isDebugged && attacher.read(piece),
        });
    }

    /** Waits for the end of the run. */
    async finish(token: vscode.CancellationToken): Promise<void> {
        const stopped = token.onCancellationRequested(() => void this.stop());
        const exit = await this.started.exit;
        stopped.dispose();
        this.fold.end('rtf ended during the test').forEach((update) => this.apply(update));
        if (exit.errors !== '') this.context.run.appendOutput(terminalText(exit.errors));
        if (!this.fold.hasStarted) this.rejected(exit);
    }

    private async stop(): Promise<void> {
        const { process, exit } = this.started;
        let hasEnded = false;
        void exit.then(() => (hasEnded = true));
        const requests = new StopRequests();
        const kill = (signal: 'SIGINT'): boolean => process.kill(signal);
        let next: NextRequest | undefined = requests.send(kill);
        while (next !== undefined) {
            // Signals of one request belong together.
            await new Promise((wake) => setTimeout(wake, 2 * REQUEST_MS));
            if (hasEnded) return;
            const action = await vscode.window.showWarningMessage(next.message, next.action);
            if (action === undefined || hasEnded) return;
            next = requests.send(kill);
        }
    }

    private enqueue(item: vscode.TestItem): void {
        this.context.run.enqueued(item);
        items(item.children).forEach((child) => this.enqueue(child));
    }

    private read(piece: string): void {
        for (const line of this.lines.push(piece)) {
            const event = parseEvent(line);
            if (event !== undefined) this.fold.apply(event).forEach((each) => this.apply(each));
        }
    }

    private apply(update: Update): void {
        const { run } = this.context;
        const location = 'location' in update ? update.location : undefined;
        const item = update.target && this.item(update.target, location);
        if (update.kind === 'output') {
            const position = item && this.position(item, location);
            run.appendOutput(terminalText(update.text), position, item);
            return;
        }
        if (item === undefined) return;
        if (update.kind === 'started') {
            run.started(item);
            return;
        }
        const messages = update.problems.map((problem) => this.message(item, problem));
        const { outcome, durationMs } = update;
        if (outcome === 'skipped') run.skipped(item);
        else if (outcome === 'passed') run.passed(item, durationMs);
        else run[outcome](item, messages, durationMs);
    }

    private item(target: Target, location?: Location): vscode.TestItem | undefined {
        const { tree } = this.context;
        const uri = vscode.Uri.file(resolve(this.dir, target.file));
        const suite = tree.controller.items.get(uri.toString());
        return suite && tree.item(suite, target, location);
    }

    private position(item: vscode.TestItem, location?: Location): vscode.Location | undefined {
        const { tree } = this.context;
        return location && tree.position(location, tree.selection(item).dirs);
    }

    private message(item: vscode.TestItem, problem: Problem): vscode.TestMessage {
        const { text, location, expected, actual } = problem;
        const message =
            expected === undefined || actual === undefined
                ? new vscode.TestMessage(text)
                : vscode.TestMessage.diff(text, expected, actual);
        const position = this.position(item, location);
        const { uri, range } = item;
        if (position !== undefined) message.location = position;
        else if (uri && range) message.location = new vscode.Location(uri, range);
        return message;
    }

    /** rtf did not start the run: its input is invalid, or it is missing. */
    private rejected({ code, signal, errors }: Exit): void {
        const text = errors.trim() || `rtf ended with ${signal ?? `code ${code}`}`;
        const { run, chosen } = this.context;
        for (const item of chosen) run.errored(item, this.message(item, { text }));
    }
}

/** A terminal expects a carriage return in each line break. */
function terminalText(text: string): string {
    return text.replace(/\r?\n/g, '\r\n');
}
