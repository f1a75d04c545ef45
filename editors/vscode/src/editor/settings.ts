// The user's settings.

import * as vscode from 'vscode';
import { expandVariables } from '../logic/command';

export interface Settings {
    /** The program. */
    path: string;
    /** The glob of suites. */
    suites: string;
    /** Further arguments of `rtf run`. */
    arguments: string[];
}

export function settingsOf(folder: vscode.WorkspaceFolder): Settings {
    const settings = vscode.workspace.getConfiguration('rtf', folder);
    const expand = (text: string): string => expandVariables(text, folder.uri.fsPath);
    return {
        path: expand(settings.get('path', 'rtf')),
        suites: settings.get('suites', '**/*.xml'),
        arguments: settings.get<string[]>('arguments', []).map(expand),
    };
}
