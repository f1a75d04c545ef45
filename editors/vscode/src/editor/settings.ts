// The user's settings.

import * as vscode from 'vscode';
import { expandVariables } from '../logic/command';

export function settingsOf(folder: vscode.WorkspaceFolder) {
    const settings = vscode.workspace.getConfiguration('rtf', folder);
    const expand = (text: string): string => expandVariables(text, folder.uri.fsPath);
    return {
        /** The program. */
        path: expand(settings.get('path', 'rtf')),
        /** The glob of suites. */
        suites: settings.get<string>('suites', '**/*.xml'),
        /** Further arguments of `rtf run`. */
        arguments: settings.get<string[]>('arguments', []).map(expand),
    };
}
