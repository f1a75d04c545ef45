// Wraps the output of a process into rows, so that a line of a
// megabyte and a log of a million lines are shown as quickly as short ones.

import { AnsiReader, type Piece } from './ansi';
import type { OutputEntry } from './api-types';

export interface OutputRow {
    pieces: Piece[];
    stream: 'stdout' | 'stderr';
    /** Whether it continues the line of the previous row. */
    isContinued: boolean;
    at: number;
}

/** Adds entries one by one; each is read once. */
export class OutputRows {
    readonly rows: OutputRow[] = [];
    private readonly readers = { stdout: new AnsiReader(), stderr: new AnsiReader() };
    private open: OutputRow | null = null;
    private filled = 0;

    constructor(readonly columns: number) {}

    add(entry: OutputEntry): void {
        if (entry.omitted_bytes !== undefined) this.gap(entry);
        const pieces = this.readers[entry.stream].read(entry.text);
        for (const piece of pieces) {
            piece.text.split('\n').forEach((text, index) => {
                if (index > 0) this.end(entry);
                this.fill(entry, { ...piece, text });
            });
        }
    }

    private gap(entry: OutputEntry): void {
        if (this.open !== null) this.end(entry);
        const text = `… ${entry.omitted_bytes} bytes left out …`;
        const row = this.row(entry, false);
        row.pieces.push({ text, classes: 'ansi-dim', color: null, background: null });
        this.end(entry);
    }

    /** Ends a line; an empty one is a row, too. */
    private end(entry: OutputEntry): void {
        if (this.open === null) this.row(entry, false);
        this.open = null;
    }

    private row(entry: OutputEntry, isContinued: boolean): OutputRow {
        const row = { pieces: [], stream: entry.stream, isContinued, at: entry.at };
        this.rows.push(row);
        this.open = row;
        this.filled = 0;
        return row;
    }

    private fill(entry: OutputEntry, piece: Piece): void {
        // Two streams do not share a row.
        if (this.open !== null && this.open.stream !== entry.stream) this.open = null;
        let rest = piece.text;
        while (rest !== '') {
            let row = this.open ?? this.row(entry, false);
            if (this.filled >= this.columns) row = this.row(entry, true);
            const text = cut(rest, this.columns - this.filled);
            if (text === '') {
                // A surrogate pair, and room for one half.
                this.filled = this.columns;
                continue;
            }
            row.pieces.push({ ...piece, text });
            this.filled += text.length;
            rest = rest.slice(text.length);
        }
    }
}

/** The first characters of a text; grapheme clusters are not split. */
function cut(text: string, length: number): string {
    if (text.length <= length) return text;
    const code = text.charCodeAt(length - 1);
    const isHalf = code >= 0xd800 && code <= 0xdbff;
    return text.slice(0, isHalf ? length - 1 : length);
}
