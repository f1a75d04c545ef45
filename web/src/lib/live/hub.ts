// One event stream per run, shared by all followers of the run. Browsers open
// at most six connections to a server: with one stream per tab, the
// seventh tab would never load.

import type { SseEvent, StreamEnd, StreamOptions } from './sse';

export type { StreamOptions };

/** The parameters of a stream. */
export interface Request {
    run: string;
    /** The number of the next event that is needed. */
    from: number;
    /** The sources whose messages and output are needed: `test:3`. */
    details: readonly string[];
}

/** A follower of a run. */
export interface Subscriber extends Omit<Request, 'run'>, Omit<StreamOptions, 'signal'> {
    ended: (end: StreamEnd) => void;
}

export type Open = (request: Request, options: StreamOptions) => Promise<StreamEnd>;

/** Followers that arrive within this time open one stream. */
const COLLECT_MS = 10;

export class Hub {
    private readonly streams = new Map<string, SharedStream>();

    constructor(private readonly open: Open) {}

    /** Follows a run until the returned function is called or the stream has ended. */
    subscribe(run: string, subscriber: Subscriber): () => void {
        let stream = this.streams.get(run);
        if (stream === undefined) {
            stream = new SharedStream(run, this.open, () => this.streams.delete(run));
            this.streams.set(run, stream);
        }
        return stream.add({ ...subscriber });
    }
}

class SharedStream {
    private readonly subscribers = new Set<Subscriber>();
    private current: AbortController | null = null;
    private isOpen = false;
    /** The number of the next event, and the requested sources. */
    private next = 0;
    private details: readonly string[] = [];
    private timer: ReturnType<typeof setTimeout> | null = null;

    constructor(
        private readonly run: string,
        private readonly open: Open,
        private readonly emptied: () => void,
    ) {}

    add(subscriber: Subscriber): () => void {
        this.subscribers.add(subscriber);
        const isSent = subscriber.details.every((each) => this.details.includes(each));
        if (this.isOpen && this.next <= subscriber.from && isSent) subscriber.opened();
        else this.restartSoon();
        return () => this.remove(subscriber);
    }

    private remove(subscriber: Subscriber): void {
        if (!this.subscribers.delete(subscriber)) return;
        if (this.subscribers.size === 0) this.stop();
        else if (this.wanted().join() !== this.details.join()) this.restartSoon();
    }

    private stop(): void {
        if (this.timer !== null) clearTimeout(this.timer);
        this.timer = null;
        this.current?.abort();
        this.current = null;
        this.isOpen = false;
        this.emptied();
    }

    private wanted(): string[] {
        return [...new Set([...this.subscribers].flatMap(({ details }) => details))].sort();
    }

    private restartSoon(): void {
        this.timer ??= setTimeout(() => {
            this.timer = null;
            void this.restart();
        }, COLLECT_MS);
    }

    private async restart(): Promise<void> {
        this.current?.abort();
        const stream = new AbortController();
        this.current = stream;
        this.isOpen = false;
        // Followers that are ahead drop known events.
        this.next = Math.min(...[...this.subscribers].map(({ from }) => from));
        this.details = this.wanted();
        const request = { run: this.run, from: this.next, details: this.details };
        const isCurrent = () => this.current === stream;
        const end = await this.open(request, {
            signal: stream.signal,
            opened: () => {
                if (!isCurrent()) return;
                this.isOpen = true;
                for (const subscriber of [...this.subscribers]) subscriber.opened();
            },
            received: (events) => isCurrent() && this.receive(events),
        });
        if (!isCurrent()) return;
        // Remaining followers subscribe again, from their current position.
        const left = [...this.subscribers];
        this.subscribers.clear();
        this.stop();
        for (const subscriber of left) subscriber.ended(end);
    }

    private receive(events: SseEvent[]): void {
        const last = Number(events.at(-1)?.id ?? NaN);
        if (Number.isFinite(last)) this.next = Math.max(this.next, last + 1);
        for (const subscriber of [...this.subscribers]) {
            subscriber.from = Math.max(subscriber.from, this.next);
            subscriber.received(events);
        }
    }
}
