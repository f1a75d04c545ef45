// The tree of the Test Explorer: suites, their tests, and the cases of those.

import { existsSync } from 'node:fs';
import { basename, dirname, relative } from 'node:path';
import * as vscode from 'vscode';
import { listCommand, type Selection } from '../logic/command';
import { type ListedCase, type ListedTest, type Location, parseList } from '../logic/list';
import { locate } from '../logic/locate';
import { parseProblems } from '../logic/problems';
import { isSuite } from '../logic/suite-file';
import type { Target } from '../logic/updates';
import { start } from './process';
import { settingsOf } from './settings';

/** What an item stands for. */
export interface ItemData extends Selection {
    /** The type of its test. */
    type?: string;
    folder: vscode.WorkspaceFolder;
    /** Directories to which names of source files may be relative. */
    dirs: string[];
}

export class Tree implements vscode.Disposable {
    private readonly data = new WeakMap<vscode.TestItem, ItemData>();
    private readonly problems = vscode.languages.createDiagnosticCollection('rtf');
    private readonly changed = new vscode.EventEmitter<void>();
    private readonly lists = new Map<string, Promise<void>>();

    /** The set of suites has changed. */
    readonly onDidChange = this.changed.event;

    constructor(
        readonly controller: vscode.TestController,
        private readonly log: vscode.LogOutputChannel,
    ) {}

    dispose(): void {
        this.problems.dispose();
        this.changed.dispose();
    }

    /** The absolute paths of all suites. */
    files(): string[] {
        return items(this.controller.items).map((item) => item.uri?.fsPath ?? '');
    }

    /** Finds all suites of the workspace. */
    async findSuites(): Promise<void> {
        const found = new Set<string>();
        for (const folder of vscode.workspace.workspaceFolders ?? []) {
            const glob = new vscode.RelativePattern(folder, settingsOf(folder).suites);
            const uris = await vscode.workspace.findFiles(glob);
            await Promise.all(uris.map((uri) => this.addFile(uri)));
            uris.forEach((uri) => found.add(uri.toString()));
        }
        for (const item of items(this.controller.items)) {
            if (!found.has(item.id)) this.removeFile(item.uri);
        }
        this.changed.fire();
    }

    /** Follows the change of an XML file. */
    async fileChanged(uri: vscode.Uri): Promise<void> {
        if (this.controller.items.get(uri.toString()) !== undefined) await this.addFile(uri);
        else if (isSuite((await readText(uri)) ?? '')) await this.findSuites();
    }

    /** Adds a file, if it is a suite, or lists its tests again. */
    private async addFile(uri: vscode.Uri): Promise<void> {
        const folder = vscode.workspace.getWorkspaceFolder(uri);
        const text = await readText(uri);
        if (folder === undefined || text === undefined || !isSuite(text)) {
            this.removeFile(uri);
            return;
        }
        const known = this.controller.items.get(uri.toString());
        if (known !== undefined) {
            if (known.children.size > 0 || known.error !== undefined) await this.list(known);
            return;
        }
        const file = uri.fsPath;
        const item = this.controller.createTestItem(uri.toString(), basename(file), uri);
        // Screen readers read it instead of the label.
        item.description = relative(folder.uri.fsPath, file);
        item.canResolveChildren = true;
        item.range = new vscode.Range(0, 0, 0, 0);
        this.data.set(item, { folder, file, dirs: [dirname(file), folder.uri.fsPath] });
        this.controller.items.add(item);
        this.changed.fire();
    }

    removeFile(uri: vscode.Uri | undefined): void {
        if (uri === undefined) return;
        this.controller.items.delete(uri.toString());
        this.problems.delete(uri);
        this.changed.fire();
    }

    /** What an item selects. */
    selection(item: vscode.TestItem): ItemData {
        return this.data.get(item) as ItemData;
    }

    /** Lists the tests of a suite. */
    list(item: vscode.TestItem): Promise<void> {
        const before = this.lists.get(item.id) ?? Promise.resolve();
        const listed = before.then(() => this.listNow(item));
        this.lists.set(item.id, listed);
        return listed;
    }

    private async listNow(item: vscode.TestItem): Promise<void> {
        const data = this.data.get(item);
        if (data === undefined || item.uri === undefined) return;
        const settings = settingsOf(data.folder);
        const dir = data.folder.uri.fsPath;
        const args = listCommand(data.file, dir, settings.arguments);
        this.log.info([settings.path, ...args].join(' '));
        item.busy = true;
        let output = '';
        const onOutput = (piece: string): void => void (output += piece);
        const { process, exit } = start(settings.path, args, dir, { onOutput });
        process.stdin?.end();
        const { code, errors } = await exit;
        item.busy = false;
        this.showProblems(item.uri, dir, errors);
        try {
            if (code !== 0) throw new Error(errors.trim() || `rtf ended with code ${code}`);
            this.replaceTests(item, data, parseList(output));
            item.error = undefined;
        } catch (error) {
            const text = error instanceof Error ? error.message : String(error);
            this.log.error(text);
            item.error = new vscode.MarkdownString().appendCodeblock(text, 'text');
        }
    }

    private replaceTests(suite: vscode.TestItem, data: ItemData, tests: ListedTest[]): void {
        suite.label = tests[0]?.suite || basename(data.file);
        suite.children.replace(tests.map((test) => this.testItem(suite, data, test)));
    }

    private testItem(suite: vscode.TestItem, data: ItemData, test: ListedTest): vscode.TestItem {
        const known = suite.children.get(test.name);
        const item = this.controller.createTestItem(test.name, test.name, suite.uri);
        const line = Math.max(test.line - 1, 0);
        item.range = new vscode.Range(line, 0, line, 0);
        item.tags = test.tags.map((tag) => new vscode.TestTag(tag));
        const dirs = [dirname(test.plugin), ...data.dirs];
        this.data.set(item, { ...data, test: test.name, type: test.type, dirs });
        const cases = test.cases.map((each) => this.listedCase(item, each));
        // Cases of plug-ins are known from their last run.
        item.children.replace(
            test.cases.length > 0 || known === undefined ? cases : items(known.children),
        );
        return item;
    }

    private listedCase(test: vscode.TestItem, listed: ListedCase): vscode.TestItem {
        const item = this.caseItem(test, listed.name, listed.location);
        if (listed.disabled === true) item.description = 'disabled';
        return item;
    }

    private caseItem(parent: vscode.TestItem, name: string, location?: Location): vscode.TestItem {
        const data = this.data.get(parent) as ItemData;
        const position = location && this.position(location, data.dirs);
        const item = this.controller.createTestItem(name, name, position?.uri ?? parent.uri);
        const range = position?.range ?? parent.range;
        if (range !== undefined) item.range = range;
        this.data.set(item, { ...data, cases: [...(data.cases ?? []), name] });
        return item;
    }

    /** The item of a target in a suite; adds a case that is new. */
    item(suite: vscode.TestItem, target: Target, location?: Location): vscode.TestItem | undefined {
        const test = target.test === undefined ? suite : suite.children.get(target.test);
        if (test === undefined) return undefined;
        return (target.cases ?? []).reduce((parent, name) => {
            const known = parent.children.get(name);
            if (known !== undefined) return known;
            const item = this.caseItem(parent, name, location);
            parent.children.add(item);
            return item;
        }, test);
    }

    /** The position of a location, if its file exists. */
    position({ file, line }: Location, dirs: readonly string[]): vscode.Location | undefined {
        const path = locate(file, dirs, existsSync);
        if (path === undefined) return undefined;
        const start = new vscode.Position(Math.max(line - 1, 0), 0);
        return new vscode.Location(vscode.Uri.file(path), start);
    }

    private showProblems(uri: vscode.Uri, dir: string, errors: string): void {
        const found = parseProblems(errors)
            .filter(({ file }) => locate(file, [dir], existsSync) === uri.fsPath)
            .map(({ severity, message, line, column }) => {
                const at = new vscode.Position(line - 1, column - 1);
                const level = vscode.DiagnosticSeverity[severity === 'error' ? 'Error' : 'Warning'];
                return new vscode.Diagnostic(new vscode.Range(at, at), message, level);
            });
        found.forEach((problem) => (problem.source = 'rtf'));
        this.problems.set(uri, found);
    }
}

/** The items of a collection. */
export function items(collection: vscode.TestItemCollection): vscode.TestItem[] {
    return [...collection].map(([, item]) => item);
}

async function readText(uri: vscode.Uri): Promise<string | undefined> {
    try {
        return new TextDecoder().decode(await vscode.workspace.fs.readFile(uri));
    } catch {
        return undefined;
    }
}
