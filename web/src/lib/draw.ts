// Draws lanes on a canvas. Of bars on the same pixel, only the worst is drawn,
// so that ten thousand bars cost no more than fit on a screen.

import { oneLine } from './ansi';
import { BAR_STATES, ticks, type Bar, type BarState, type Lane, type View } from './timeline';

export const LANE = 22;
export const TOP = 22;
export const GUTTER = 150;

export interface Frame {
    width: number;
    height: number;
    gutter: number;
    scroll: number;
    view: View;
    /** The end of the run so far. */
    end: number;
}

export type Palette = Record<'text' | 'muted' | 'border' | 'surface' | 'font', string> & {
    bars: Record<BarState, string>;
    mark: string;
};

/** The canvas's context, scaled to the screen, at this size of the canvas in the page. */
export function contextOf(
    canvas: HTMLCanvasElement,
    width: number,
    height: number,
): CanvasRenderingContext2D | null {
    const context = canvas.getContext('2d');
    const ratio = devicePixelRatio || 1;
    const size = { width: Math.round(width * ratio), height: Math.round(height * ratio) };
    // Setting the size clears the canvas, even if it does not change.
    if (canvas.width !== size.width) canvas.width = size.width;
    if (canvas.height !== size.height) canvas.height = size.height;
    context?.setTransform(ratio, 0, 0, ratio, 0, 0);
    return context;
}

/** The colours of the theme. `isDark` makes callers depend on the theme. */
export function palette(element: Element, isDark: boolean): Palette {
    const style = getComputedStyle(element);
    const read = (name: string) => style.getPropertyValue(`--${name}`).trim();
    const bars = BAR_STATES.map((each) => [each, read(`bar-${each}`)]);
    return {
        text: read('text'),
        muted: read('muted'),
        border: read('border'),
        surface: read('surface'),
        font: `11.5px ${read('font')}`,
        mark: isDark ? '#ffffff' : '#18202c',
        bars: Object.fromEntries(bars) as Palette['bars'],
    };
}

export function draw(
    context: CanvasRenderingContext2D,
    lanes: Lane[],
    frame: Frame,
    colours: Palette,
): void {
    const { width, height, scroll } = frame;
    context.fillStyle = colours.surface;
    context.fillRect(0, 0, width, height);
    context.font = colours.font;
    context.textBaseline = 'middle';
    drawGrid(context, frame, colours);
    const first = Math.max(0, Math.floor(scroll / LANE));
    const last = Math.min(lanes.length, Math.ceil((scroll + height - TOP) / LANE));
    for (let index = first; index < last; index += 1) {
        const lane = lanes[index];
        if (lane !== undefined)
            drawLane(context, lane, TOP + index * LANE - scroll, frame, colours);
    }
    context.fillStyle = colours.surface;
    context.fillRect(0, 0, width, TOP - 3);
    drawLabels(context, frame, colours);
}

function xOf(at: number, { gutter, width, view }: Frame): number {
    return gutter + ((at - view.from) / (view.to - view.from)) * (width - gutter - 8);
}

function ticksOf(frame: Frame) {
    return ticks(frame.view, Math.max(2, Math.floor((frame.width - frame.gutter) / 90)));
}

function drawGrid(context: CanvasRenderingContext2D, frame: Frame, colours: Palette): void {
    context.strokeStyle = colours.border;
    context.lineWidth = 1;
    context.beginPath();
    for (const { at } of ticksOf(frame)) {
        const x = Math.round(xOf(at, frame)) + 0.5;
        context.moveTo(x, TOP - 3);
        context.lineTo(x, frame.height);
    }
    context.stroke();
}

function drawLabels(context: CanvasRenderingContext2D, frame: Frame, colours: Palette): void {
    context.fillStyle = colours.muted;
    context.textAlign = 'center';
    for (const { at, label } of ticksOf(frame)) {
        const x = xOf(at, frame);
        if (x < frame.width - 16) context.fillText(label, Math.max(x, frame.gutter + 8), 10);
    }
    context.textAlign = 'left';
}

function drawLane(
    context: CanvasRenderingContext2D,
    lane: Lane,
    y: number,
    frame: Frame,
    colours: Palette,
): void {
    const { width, gutter } = frame;
    const isSuite = lane.kind === 'suite';
    const height = isSuite ? 16 : 10;
    const top = y + (LANE - height) / 2;
    context.save();
    context.beginPath();
    context.rect(gutter, y, width - gutter, LANE);
    context.clip();
    for (const { x, to, bar } of pixels(lane, frame)) {
        context.fillStyle = colours.bars[bar.state];
        context.fillRect(x, top, to - x, height);
        if (bar.state === 'collapsed' && lane.kind === 'fixture') {
            hatch(context, { x, y: top, width: to - x, height }, colours.surface);
        }
        if (isSuite && to - x > 60) drawName(context, bar, { x, to, y }, colours);
    }
    for (const mark of lane.marks) drawMark(context, mark.kind, xOf(mark.at, frame), y, colours);
    context.restore();
    context.fillStyle = colours.surface;
    context.fillRect(0, y, gutter - 4, LANE);
    if (lane.row > 0) return;
    context.fillStyle = isSuite ? colours.text : colours.muted;
    const indent = isSuite ? 14 : 26;
    const label = fit(context, oneLine(lane.name), gutter - indent - 8);
    context.fillText(label, indent, y + LANE / 2 + 0.5);
}

/** The visible bars, at most one per pixel. */
function* pixels(lane: Lane, frame: Frame): Generator<{ x: number; to: number; bar: Bar }> {
    let open: { x: number; to: number; bar: Bar } | null = null;
    for (const bar of lane.bars) {
        const end = bar.to ?? frame.end;
        if (end < frame.view.from || bar.from > frame.view.to) continue;
        const x = Math.max(xOf(bar.from, frame), frame.gutter - 2);
        const right = Math.min(xOf(end, frame), frame.width);
        // A gap of one pixel separates two bars, if there is room for it.
        const to = Math.max(right - (right - x > 4 ? 1 : 0), x + 1.5);
        if (open !== null && to - x < 2.5 && x - open.to < 0.5 && open.to - open.x < 3) {
            open = {
                x: open.x,
                to: Math.max(open.to, to),
                bar: open.bar.state === 'passed' ? bar : open.bar,
            };
            continue;
        }
        if (open !== null) yield open;
        open = { x, to, bar };
    }
    if (open !== null) yield open;
}

function drawName(
    context: CanvasRenderingContext2D,
    { label, state }: Bar,
    { x, to, y }: { x: number; to: number; y: number },
    colours: Palette,
): void {
    context.fillStyle = state === 'running' ? '#ffffff' : colours.mark;
    const from = Math.max(x, 0) + 5;
    context.fillText(fit(context, oneLine(label), to - from - 4), from, y + LANE / 2 + 0.5);
}

/** The text, shortened to this width. */
export function fit(context: CanvasRenderingContext2D, text: string, room: number): string {
    // Longer labels do not fit on any screen.
    let shown = text.slice(0, 300);
    if (context.measureText(shown).width <= room) return shown;
    let [low, high] = [0, shown.length];
    while (low < high) {
        const middle = Math.ceil((low + high) / 2);
        if (context.measureText(`${shown.slice(0, middle)}…`).width <= room) low = middle;
        else high = middle - 1;
    }
    shown = shown.slice(0, low);
    return low === 0 ? '' : `${shown}…`;
}

function hatch(
    context: CanvasRenderingContext2D,
    { x, y, width, height }: { x: number; y: number; width: number; height: number },
    colour: string,
): void {
    context.save();
    context.beginPath();
    context.rect(x, y, width, height);
    context.clip();
    context.strokeStyle = colour;
    context.lineWidth = 1.5;
    context.beginPath();
    for (let from = x - height; from < x + width; from += 5) {
        context.moveTo(from, y + height);
        context.lineTo(from + height, y);
    }
    context.stroke();
    context.restore();
}

/** A cross for a collapse, an arrow for a restart, a bar for another problem. */
function drawMark(
    context: CanvasRenderingContext2D,
    kind: Lane['marks'][number]['kind'],
    x: number,
    y: number,
    colours: Palette,
): void {
    const middle = y + LANE / 2;
    context.lineWidth = 2;
    context.strokeStyle = kind === 'restarted' ? colours.text : colours.bars.collapsed;
    context.fillStyle = colours.surface;
    context.beginPath();
    context.arc(x, middle, 7, 0, Math.PI * 2);
    context.fill();
    context.beginPath();
    if (kind === 'collapsed') {
        context.moveTo(x - 4, middle - 4);
        context.lineTo(x + 4, middle + 4);
        context.moveTo(x + 4, middle - 4);
        context.lineTo(x - 4, middle + 4);
    } else if (kind === 'restarted') {
        context.arc(x, middle, 4, -0.3, Math.PI * 1.5);
        context.moveTo(x - 3, middle - 6.5);
        context.lineTo(x + 0.5, middle - 4);
        context.lineTo(x - 2.5, middle - 1.5);
    } else {
        context.moveTo(x, middle - 5);
        context.lineTo(x, middle + 1);
        context.moveTo(x, middle + 3.5);
        context.lineTo(x, middle + 5);
    }
    context.stroke();
}
