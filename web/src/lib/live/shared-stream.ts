// A stream of a run's events, over the connection that all pages share. If the
// browser has no shared workers, each page opens a connection.

import type { Request, StreamOptions } from './hub';
import { openStream } from './open-stream';
import type { StreamEnd } from './sse';
import type { FromWorker, ToWorker } from './worker-messages';

interface Stream {
    options: StreamOptions;
    end: (end: StreamEnd) => void;
}

class Streams {
    private readonly open = new Map<number, Stream>();
    private last = 0;

    constructor(private readonly worker: SharedWorker) {
        worker.port.onmessage = ({ data }: MessageEvent<FromWorker>) => this.receive(data);
        // A page that is closed or suspended notifies the worker.
        addEventListener('pagehide', () => this.closeAll());
    }

    follow(request: Request, options: StreamOptions): Promise<StreamEnd> {
        const id = (this.last += 1);
        return new Promise((resolve) => {
            const end = (ended: StreamEnd) => {
                this.open.delete(id);
                options.signal.removeEventListener('abort', abort);
                resolve(ended);
            };
            const abort = () => {
                this.send({ kind: 'close', id });
                end({ lost: true });
            };
            if (options.signal.aborted) return end({ lost: true });
            options.signal.addEventListener('abort', abort);
            this.open.set(id, { options, end });
            this.send({ kind: 'open', id, ...request });
        });
    }

    closeAll(): void {
        for (const [id, { end }] of [...this.open]) {
            this.send({ kind: 'close', id });
            end({ lost: true });
        }
    }

    private send(message: ToWorker): void {
        this.worker.port.postMessage(message);
    }

    private receive(message: FromWorker): void {
        const stream = this.open.get(message.id);
        if (stream === undefined) return;
        if (message.kind === 'opened') stream.options.opened();
        else if (message.kind === 'received') stream.options.received(message.events);
        else stream.end(message.end);
    }
}

let streams: Streams | null | undefined;

function shared(): Streams | null {
    if (streams !== undefined) return streams;
    if (typeof SharedWorker === 'undefined') return (streams = null);
    try {
        const worker = new SharedWorker(new URL('./streams.worker.ts', import.meta.url), {
            type: 'module',
            name: 'rtf-streams',
        });
        const made = new Streams(worker);
        worker.onerror = () => {
            // The worker cannot be loaded: use a separate connection.
            streams = null;
            made.closeAll();
        };
        streams = made;
    } catch {
        streams = null;
    }
    return streams;
}

/** Follows a run until the stream ends or is aborted. */
export function followRun(request: Request, options: StreamOptions): Promise<StreamEnd> {
    return shared()?.follow(request, options) ?? openStream(request, options);
}
