// The data in a report: chunks of compressed JSON, each of which is read when it is needed
// (spec/reports.md).

import { Recent } from '../recent';

/** The number of chunks that stay in memory, decoded. */
const KEPT = 16;

/** Reads named blocks of data. */
export interface Data {
    readBlock<T>(name: string): Promise<T>;
}

export class EmbeddedData implements Data {
    private readonly decoded = new Recent<Promise<unknown>>(KEPT);

    constructor(private readonly document: Document) {}

    readBlock<T>(name: string): Promise<T> {
        const block = this.decoded.get(name) ?? this.decode(name);
        // A block that is used again is kept longer.
        this.decoded.set(name, block);
        return block as Promise<T>;
    }

    private async decode(name: string): Promise<unknown> {
        const text = this.document.getElementById(`rtf-${name}`)?.textContent;
        if (text == null) throw new Error(`the block ${name} is missing`);
        const unzipped = new Blob([fromBase64(text.trim())])
            .stream()
            .pipeThrough(new DecompressionStream('gzip'));
        return new Response(unzipped).json();
    }
}

function fromBase64(text: string): Uint8Array<ArrayBuffer> {
    const binary = atob(text);
    const bytes = new Uint8Array(binary.length);
    for (let index = 0; index < binary.length; index += 1) bytes[index] = binary.charCodeAt(index);
    return bytes;
}
