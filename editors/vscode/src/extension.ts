// The extension: tests of the Robot Testing Framework in the Test Explorer.

import * as vscode from 'vscode';
import { runTests } from './editor/run';
import { SuiteSchema } from './editor/schemas';
import { items, Tree } from './editor/tree';

/** Called by the editor after its start: a search for suites in `activationEvents` would give
 *  up after a few seconds. */
export async function activate(context: vscode.ExtensionContext): Promise<void> {
    const log = vscode.window.createOutputChannel('Robot Testing Framework', { log: true });
    const controller = vscode.tests.createTestController('rtf', 'Robot Testing Framework');
    const tree = new Tree(controller, log);
    const schema = new SuiteSchema(context);
    controller.resolveHandler = async (item): Promise<void> => {
        await (item === undefined ? tree.findSuites() : tree.list(item));
    };
    controller.refreshHandler = async (): Promise<void> => {
        await tree.findSuites();
        await Promise.all(items(controller.items).map((item) => tree.list(item)));
    };
    const run = (request: vscode.TestRunRequest, token: vscode.CancellationToken): Promise<void> =>
        runTests(tree, request, token, log);
    controller.createRunProfile('Run', vscode.TestRunProfileKind.Run, run, true);
    controller.createRunProfile('Debug', vscode.TestRunProfileKind.Debug, run, true);
    context.subscriptions.push(
        log,
        controller,
        tree,
        tree.onDidChange(() => void schema.associate(tree.files())),
        vscode.commands.registerCommand('rtf.showLog', () => log.show()),
        ...watch(tree),
    );
    await tree.findSuites();
}

/** Follows changes of suites, also those that other programs make. */
function watch(tree: Tree): vscode.Disposable[] {
    const watcher = vscode.workspace.createFileSystemWatcher('**/*.xml');
    return [
        watcher,
        watcher.onDidCreate((uri) => void tree.fileChanged(uri)),
        watcher.onDidChange((uri) => void tree.fileChanged(uri)),
        watcher.onDidDelete((uri) => tree.removeFile(uri)),
        vscode.workspace.onDidChangeConfiguration((change) => {
            if (change.affectsConfiguration('rtf')) void tree.findSuites();
        }),
        vscode.workspace.onDidChangeWorkspaceFolders(() => void tree.findSuites()),
        // The buttons next to tests need their lines.
        vscode.workspace.onDidOpenTextDocument((document) => {
            const item = tree.controller.items.get(document.uri.toString());
            if (item !== undefined && item.children.size === 0) void tree.list(item);
        }),
    ];
}
