// Finds the positions in what `rtf` prints about an invalid suite.

/** A problem that `rtf list` reports. Lines and columns are from 1. */
export interface Problem {
    severity: 'error' | 'warning';
    message: string;
    file: string;
    line: number;
    column: number;
}

const HEADING = /^(error|warning): (.*)$/;
const POSITION = /^ *--> (.*):(\d+):(\d+)$/;

/** Returns the problems with a position. */
export function parseProblems(text: string): Problem[] {
    const problems: Problem[] = [];
    let heading: RegExpExecArray | null = null;
    for (const line of text.split('\n')) {
        heading = HEADING.exec(line) ?? heading;
        const position = POSITION.exec(line);
        if (heading === null || position === null) continue;
        problems.push({
            severity: heading[1] === 'warning' ? 'warning' : 'error',
            message: heading[2] ?? '',
            file: position[1] ?? '',
            line: Number(position[2]),
            column: Number(position[3]),
        });
        heading = null;
    }
    return problems;
}
