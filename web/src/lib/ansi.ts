// Splits the output of a process into pieces of styled text. Colours and
// weights are supported; every other escape sequence is removed, so that
// output can only change its own style.

/** A piece of text in one style. `classes` are CSS classes of the page. */
export interface Piece {
    text: string;
    classes: string;
    /** Colours beyond the sixteen named ones, as `rgb(…)`. */
    color: string | null;
    background: string | null;
}

interface Style {
    flags: Set<string>;
    foreground: string | null;
    background: string | null;
}

// CSI sequences, OSC and other strings up to their end, two-character escapes,
// and the same with the 8-bit introducers. Of an unterminated string, only
// the introducer is removed.
const ESCAPE =
    /(?:\x1b\[|\x9b)([0-?]*)[ -/]*([@-~])|(?:\x1b[\]PX^_]|[\x90\x98\x9d-\x9f])[^\x07\x1b\x9c]{0,4096}(?:\x07|\x1b\\|\x9c)|\x1b[ -/]*[0-~]/g;

const NAMES = ['black', 'red', 'green', 'yellow', 'blue', 'magenta', 'cyan', 'white'];
const FLAGS = new Map([
    [1, 'bold'],
    [2, 'dim'],
    [3, 'italic'],
    [4, 'underline'],
    [7, 'inverse'],
    [9, 'strike'],
]);

/** Reads a text; the style continues from piece to piece. */
export class AnsiReader {
    private style: Style = { flags: new Set(), foreground: null, background: null };

    read(text: string): Piece[] {
        const pieces: Piece[] = [];
        let from = 0;
        for (const match of text.matchAll(ESCAPE)) {
            this.push(pieces, text.slice(from, match.index));
            from = match.index + match[0].length;
            if (match[2] === 'm') this.select(match[1] ?? '');
        }
        this.push(pieces, text.slice(from));
        return pieces;
    }

    private push(pieces: Piece[], text: string): void {
        if (text === '') return;
        const { flags, foreground, background } = this.style;
        const classes = [...flags].map((flag) => `ansi-${flag}`);
        if (foreground !== null && !foreground.startsWith('rgb'))
            classes.push(`ansi-${foreground}`);
        if (background !== null && !background.startsWith('rgb'))
            classes.push(`ansi-on-${background}`);
        pieces.push({
            text: visible(text),
            classes: classes.join(' '),
            color: foreground?.startsWith('rgb') ? foreground : null,
            background: background?.startsWith('rgb') ? background : null,
        });
    }

    private select(parameters: string): void {
        const codes = parameters.split(/[;:]/).map((code) => Number.parseInt(code || '0', 10));
        for (let index = 0; index < codes.length; index += 1) {
            const code = codes[index] ?? 0;
            if (code === 38 || code === 48) {
                const [colour, used] = extended(codes.slice(index + 1));
                if (code === 38) this.style.foreground = colour;
                else this.style.background = colour;
                index += used;
            } else {
                this.apply(code);
            }
        }
    }

    private apply(code: number): void {
        const style = this.style;
        const flag = FLAGS.get(code);
        if (code === 0) this.style = { flags: new Set(), foreground: null, background: null };
        else if (flag !== undefined) style.flags.add(flag);
        else if (code === 22) ['bold', 'dim'].forEach((each) => style.flags.delete(each));
        else if (code >= 23 && code <= 29) style.flags.delete(FLAGS.get(code - 20) ?? '');
        else if (code >= 30 && code <= 37) style.foreground = named(code - 30);
        else if (code >= 40 && code <= 47) style.background = named(code - 40);
        else if (code >= 90 && code <= 97) style.foreground = named(code - 90 + 8);
        else if (code >= 100 && code <= 107) style.background = named(code - 100 + 8);
        else if (code === 39) style.foreground = null;
        else if (code === 49) style.background = null;
    }
}

/** One of the sixteen colours: `red`, `bright-red`. */
function named(index: number): string {
    const name = NAMES[index % 8] ?? 'white';
    return index < 8 ? name : `bright-${name}`;
}

/** The colour after 38 or 48, and the number of parameters that it uses. */
function extended(codes: number[]): [string | null, number] {
    const byte = (index: number) => Math.min(255, Math.max(0, codes[index] || 0));
    if (codes[0] === 2) return [`rgb(${byte(1)}, ${byte(2)}, ${byte(3)})`, 4];
    if (codes[0] !== 5) return [null, 0];
    const index = byte(1);
    if (index < 16) return [named(index), 2];
    if (index >= 232) {
        const grey = 8 + (index - 232) * 10;
        return [`rgb(${grey}, ${grey}, ${grey})`, 2];
    }
    const level = (step: number) => (step === 0 ? 0 : 55 + step * 40);
    const cube = index - 16;
    const [red, green, blue] = [Math.floor(cube / 36), Math.floor(cube / 6) % 6, cube % 6];
    return [`rgb(${level(red)}, ${level(green)}, ${level(blue)})`, 2];
}

// The names of the first 32 characters.
const CONTROLS = (
    'NUL SOH STX ETX EOT ENQ ACK BEL BS TAB LF VT FF CR SO SI ' +
    'DLE DC1 DC2 DC3 DC4 NAK SYN ETB CAN EM SUB ESC FS GS RS US'
).split(' ');

/**
 * Makes control characters visible: NUL becomes ⟨NUL⟩. Line breaks and
 * tabs stay; characters that change the text direction are shown by
 * name, because they can disguise a text.
 */
export function visible(text: string): string {
    return text
        .replace(/\r\n/g, '\n')
        .replace(
            /[\0-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]/g,
            spelled,
        );
}

function spelled(character: string): string {
    const code = character.charCodeAt(0);
    const hex = code.toString(16).toUpperCase().padStart(4, '0');
    return `⟨${CONTROLS[code] ?? (code === 127 ? 'DEL' : `U+${hex}`)}⟩`;
}

/** A name on one line. */
export function oneLine(text: string): string {
    return visible(text).replace(/[\n\t]/g, spelled);
}

/** A text without its colours. */
export function plain(text: string): string {
    return visible(text.replace(ESCAPE, ''));
}
