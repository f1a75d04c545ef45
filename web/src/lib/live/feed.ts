// Keeps a record up to date: loads the snapshot, follows the events, resumes
// an interrupted stream, and starts over when the server requires it.

import { ApiError, snapshot } from '../api';
import type { RunStateName } from '../api-types';
import type { Event } from '../event';
import { messageOf } from '../task.svelte';
import { RunRecord } from '../record/record';
import { followRun } from './shared-stream';
import type { SseEvent } from './sse';

export type Connection =
    | { kind: 'loading' }
    | { kind: 'live' }
    /** The page is hidden, and resumes when it is visible. */
    | { kind: 'paused' }
    | { kind: 'reconnecting'; reason: string }
    | { kind: 'ended' }
    | { kind: 'refused'; status: number; reason: string };

export interface Listener {
    /** A new record, which replaces the previous one. */
    loaded: (record: RunRecord) => void;
    /** The record has changed. `details` are events that it does not keep. */
    changed: (events: Event[]) => void;
    connected: (connection: Connection) => void;
}

const FIRST_DELAY_MS = 250;
const LAST_DELAY_MS = 5000;

export class Feed {
    private record: RunRecord | null = null;
    /** A new snapshot must replace the record. */
    private isStale = true;
    private details: readonly string[] = [];
    private stream: AbortController | null = null;
    private readonly closing = new AbortController();

    constructor(
        private readonly run: string,
        private readonly listener: Listener,
    ) {}

    /** Loads and follows until the run has ended or the feed is closed. */
    async start(): Promise<void> {
        const hidden = () => document.hidden && this.stream?.abort();
        document.addEventListener('visibilitychange', hidden);
        await this.follow();
        document.removeEventListener('visibilitychange', hidden);
    }

    private async follow(): Promise<void> {
        let delay = FIRST_DELAY_MS;
        while (!this.closing.signal.aborted) {
            const step = await this.step();
            if (step === 'over') return;
            if (step === 'again') {
                delay = FIRST_DELAY_MS;
                continue;
            }
            await this.pause(delay);
            delay = Math.min(delay * 2, LAST_DELAY_MS);
        }
    }

    close(): void {
        this.closing.abort();
        this.stream?.abort();
    }

    /** The sources whose messages, measurements and output are requested: `test:3`. */
    watch(sources: string[]): void {
        if (sources.join() === this.details.join()) return;
        this.details = sources;
        this.stream?.abort();
    }

    private async step(): Promise<'over' | 'again' | 'wait'> {
        try {
            if (this.isStale) await this.load();
            return await this.listen();
        } catch (problem) {
            if (this.closing.signal.aborted) return 'over';
            return this.failed(problem);
        }
    }

    private failed(problem: unknown): 'over' | 'wait' {
        if (this.record?.isOver) {
            // The server has exited with its run: there is nothing more to load.
            this.listener.connected({ kind: 'ended' });
            return 'over';
        }
        const status = problem instanceof ApiError ? problem.status : 0;
        const reason = messageOf(problem);
        if (status >= 400 && status < 500) {
            this.listener.connected({ kind: 'refused', status, reason });
            return 'over';
        }
        this.listener.connected({ kind: 'reconnecting', reason });
        return 'wait';
    }

    private async load(): Promise<void> {
        this.record = new RunRecord(await snapshot(this.run, this.closing.signal));
        this.isStale = false;
        this.listener.loaded(this.record);
    }

    private async listen(): Promise<'over' | 'again' | 'wait'> {
        const { record } = this;
        if (record === null) return 'again';
        if (record.isOver) {
            this.listener.connected({ kind: 'ended' });
            return 'over';
        }
        if (document.hidden) {
            this.listener.connected({ kind: 'paused' });
            await this.shown();
            return 'again';
        }
        const stream = new AbortController();
        this.stream = stream;
        let connected = false;
        const request = { run: this.run, from: record.info.seq, details: this.details };
        const end = await followRun(request, {
            signal: stream.signal,
            opened: () => {
                connected = true;
                this.listener.connected({ kind: 'live' });
            },
            received: (events) => this.receive(events, stream),
        });
        if (this.closing.signal.aborted) return 'over';
        if (stream.signal.aborted) return 'again';
        if ('status' in end && end.status === 204) {
            // The run has ended, and all its events are known.
            this.isStale = true;
            return 'again';
        }
        if ('status' in end) throw new ApiError(end.status, `the server answers ${end.status}`);
        this.listener.connected({ kind: 'reconnecting', reason: 'the connection was lost' });
        return connected ? 'again' : 'wait';
    }

    private receive(received: SseEvent[], stream: AbortController): void {
        // The next stream repeats what an abandoned one still delivers.
        if (stream.signal.aborted) return;
        const { record } = this;
        const events: Event[] = [];
        for (const { type, id, data } of received) {
            if (record === null) break;
            if (type === 'message') {
                const event = JSON.parse(data) as Event;
                if (event.seq < record.info.seq) continue;
                record.apply(event);
                events.push(event);
            } else if (type === 'progress') {
                const { last_at } = JSON.parse(data) as { last_at: number };
                record.progress(Number(id), last_at);
            } else if (type === 'resync' || type === 'end') {
                // In both cases, a new snapshot is loaded.
                this.isStale = true;
                if (type === 'end')
                    record.finish((JSON.parse(data) as { state: RunStateName }).state);
                stream.abort();
                break;
            }
        }
        this.listener.changed(events);
    }

    /** Waits until the page is visible, or the feed is closed. */
    private async shown(): Promise<void> {
        while (document.hidden && !this.closing.signal.aborted)
            await this.oneOf([document, 'visibilitychange']);
    }

    private pause(milliseconds: number): Promise<void> {
        return this.oneOf([window, 'online'], [AbortSignal.timeout(milliseconds), 'abort']);
    }

    /** Waits for one of these events, or until the feed is closed. */
    private oneOf(...events: [EventTarget, string][]): Promise<void> {
        const waiting = new AbortController();
        return new Promise((resolve) => {
            const done = () => {
                waiting.abort();
                resolve();
            };
            for (const [target, type] of [...events, [this.closing.signal, 'abort'] as const])
                target.addEventListener(type, done, { signal: waiting.signal });
        });
    }
}
