// Splits a stream of text into lines.

export class Lines {
    private rest = '';

    /** Returns the lines that a further piece completes. */
    push(piece: string): string[] {
        const lines = (this.rest + piece).split('\n');
        this.rest = lines.pop() ?? '';
        return lines;
    }
}
