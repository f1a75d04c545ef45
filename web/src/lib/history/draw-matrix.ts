// Draws the visible part of the matrix of verdicts on a canvas.

import { oneLine } from '../ansi';
import { fit, type Palette } from '../draw';
import { LETTERS, type MatrixRow } from './matrix';

export const CELL = { width: 12, height: 18 };
/** The height of the days above the columns. */
export const HEAD = 20;

export interface MatrixFrame {
    width: number;
    height: number;
    /** The width of the names. */
    gutter: number;
    scroll: { left: number; top: number };
    cursor: { row: number; column: number } | null;
}

/** The visible rows and columns: from the first, up to and without the last. */
export function visible(frame: MatrixFrame, rows: number, columns: number) {
    const { width, height, gutter, scroll } = frame;
    const last = (end: number, size: number, most: number) => Math.min(most, Math.ceil(end / size));
    return {
        rows: [
            Math.floor(scroll.top / CELL.height),
            last(scroll.top + height - HEAD, CELL.height, rows),
        ] as const,
        columns: [
            Math.floor(scroll.left / CELL.width),
            last(scroll.left + width - gutter, CELL.width, columns),
        ] as const,
    };
}

export function drawMatrix(
    context: CanvasRenderingContext2D,
    content: { rows: readonly MatrixRow[]; days: readonly string[] },
    frame: MatrixFrame,
    colours: Palette,
): void {
    const { width, height, scroll } = frame;
    const { rows, days } = content;
    context.fillStyle = colours.surface;
    context.fillRect(0, 0, width, height);
    context.font = colours.font;
    context.textBaseline = 'middle';
    const seen = visible(frame, rows.length, days.length);
    for (let index = seen.rows[0]; index < seen.rows[1]; index += 1) {
        const row = rows[index];
        if (row === undefined) continue;
        const y = HEAD + index * CELL.height - scroll.top;
        drawCells(context, row.verdicts, { y, columns: seen.columns }, frame, colours);
    }
    drawCursor(context, frame, colours);
    drawNames(context, rows, seen.rows, frame, colours);
    drawDays(context, days, seen.columns, frame, colours);
}

function drawCells(
    context: CanvasRenderingContext2D,
    verdicts: string,
    { y, columns }: { y: number; columns: readonly [number, number] },
    { gutter, scroll }: MatrixFrame,
    colours: Palette,
): void {
    for (let column = columns[0]; column < columns[1]; column += 1) {
        const letter = verdicts[column] ?? '-';
        const verdict = LETTERS[letter];
        if (verdict === undefined) continue;
        const x = gutter + column * CELL.width - scroll.left;
        context.fillStyle = colours.bars[verdict];
        context.fillRect(x, y + 1, CELL.width - 1, CELL.height - 2);
        // Not only the colour tells problems apart.
        if (letter !== 'p') {
            context.fillStyle = colours.mark;
            context.fillText(letter, x + 2.5, y + CELL.height / 2 + 0.5);
        }
    }
}

function drawCursor(context: CanvasRenderingContext2D, frame: MatrixFrame, colours: Palette) {
    const { cursor, gutter, scroll } = frame;
    if (cursor === null) return;
    const x = gutter + cursor.column * CELL.width - scroll.left;
    const y = HEAD + cursor.row * CELL.height - scroll.top;
    context.strokeStyle = colours.text;
    context.lineWidth = 2;
    context.strokeRect(x - 0.5, y, CELL.width, CELL.height);
}

function drawNames(
    context: CanvasRenderingContext2D,
    rows: readonly MatrixRow[],
    [first, last]: readonly [number, number],
    { height, gutter, scroll, cursor }: MatrixFrame,
    colours: Palette,
): void {
    context.fillStyle = colours.surface;
    context.fillRect(0, 0, gutter - 2, height);
    for (let index = first; index < last; index += 1) {
        const y = HEAD + (index + 0.5) * CELL.height - scroll.top + 0.5;
        context.fillStyle = cursor?.row === index ? colours.text : colours.muted;
        context.fillText(fit(context, oneLine(rows[index]?.name ?? ''), gutter - 14), 8, y);
    }
}

/** The day of the first visible run, and of each first run of a day, where there is room. */
function drawDays(
    context: CanvasRenderingContext2D,
    days: readonly string[],
    [first, last]: readonly [number, number],
    { width, gutter, scroll }: MatrixFrame,
    colours: Palette,
): void {
    context.fillStyle = colours.surface;
    context.fillRect(0, 0, width, HEAD - 2);
    context.fillStyle = colours.muted;
    let free = gutter;
    for (let column = first; column < last; column += 1) {
        const x = gutter + column * CELL.width - scroll.left;
        const day = days[column] ?? '';
        if (x < free || (column > first && day === days[column - 1])) continue;
        context.fillText(day, x, HEAD / 2);
        free = x + 80;
    }
}
