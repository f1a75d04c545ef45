// The command lines with which the extension starts rtf.

import { isAbsolute, relative, sep } from 'node:path';

/** What is selected in the Test Explorer. */
export interface Selection {
    /** The absolute path of the suite. */
    file: string;
    /** A test; without it, the suite. */
    test?: string;
    /** The path of a case: its name, preceded by those of the cases that contain it. */
    cases?: readonly string[];
}

/** Options of `rtf run` that `rtf list` has, too, and that change what is listed. */
const PLAN_OPTIONS = new Set(['--profile', '--set', '--environment']);

/** Returns the name of a file for rtf: relative to the directory in which it is started. */
export function inputName(file: string, dir: string): string {
    const name = relative(dir, file);
    if (isAbsolute(name) || name.startsWith(`..${sep}`)) return file;
    return name.startsWith('-') ? `.${sep}${name}` : name;
}

/** Returns the argument that selects a suite, a test or a case. */
export function selector({ file, test, cases }: Selection, dir: string): string {
    const name = inputName(file, dir);
    if (test === undefined) return name;
    return [`${name}::${test}`, ...(cases ?? [])].join('/');
}

/** Returns those of the user's arguments that also apply when tests are listed. */
export function planArguments(args: readonly string[]): string[] {
    const plan: string[] = [];
    for (let at = 0; at < args.length; at += 1) {
        const arg = args[at] ?? '';
        const [option = ''] = arg.split('=', 1);
        if (!PLAN_OPTIONS.has(option)) continue;
        plan.push(arg);
        const value = args[at + 1];
        if (option === arg && value !== undefined) {
            plan.push(value);
            at += 1;
        }
    }
    return plan;
}

/** `rtf list` of one suite. */
export function listCommand(file: string, dir: string, args: readonly string[]): string[] {
    return ['list', '--format', 'json', ...planArguments(args), inputName(file, dir)];
}

/** `rtf run` with the event stream on standard output. It ends with the editor. */
export function runCommand(
    selections: readonly Selection[],
    dir: string,
    args: readonly string[],
): string[] {
    const inputs = selections.map((selection) => selector(selection, dir));
    return ['run', '--format', 'json', '--end-with-stdin', ...args, ...inputs];
}

/** Replaces the variables of a setting. */
export function expandVariables(text: string, workspaceFolder: string): string {
    return text.replaceAll('${workspaceFolder}', workspaceFolder);
}
