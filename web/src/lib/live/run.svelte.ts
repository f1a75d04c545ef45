// The shown run, for components. Ten thousand tests are too many to
// observe each field: the record is plain data, and once per frame
// there is a new view of it if something has changed. Objects of the
// record keep their identity while they change; components copy what they show.

import { flushSync } from 'svelte';
import * as api from '../api';
import type { Event } from '../event';
import { Recent } from '../recent';
import { RunRecord } from '../record/record';
import type { Content } from './details.svelte';
import { Feed, type Connection } from './feed';

/** Maximum number of details that are kept. */
const KEPT = 30;

/** Receives new events until it is removed. */
type DetailListener = (events: Event[]) => void;

const FRAME_MS = 16;
/** The minimum time between two draws: faster updates are not visible, and the tests need the CPU. */
const BETWEEN_MS = 100;
/** Drawing may take at most 1/n of the time. */
const SHARE = 5;
/** The maximum time between two draws. */
const LATEST_MS = 120;
/** The interval between draws of expensive parts. */
const CALM_MS = 500;

export class LiveRun {
    connection: Connection = $state.raw({ kind: 'loading' });
    /** The record; a new object after each change. */
    record: RunRecord = $state.raw(new RunRecord());
    /** The same, updated less often: for parts that are expensive to draw. */
    calm: RunRecord = $state.raw(new RunRecord());
    /** Microseconds since the run started, as of `calm`. */
    now = $state(0);
    /** The marked moment in the timeline, in microseconds since the run's start. */
    moment: number | null = $state(null);
    /** Incremented with each new record: loaded details are outdated. */
    generation = $state(0);
    /** Loaded details of attempts, starts and hook runs: they stay when the server exits. */
    readonly kept = new Recent<Content>(KEPT);
    private readonly feed: Feed;
    private readonly listeners = new Set<DetailListener>();
    private readonly watched = new Map<symbol, string[]>();
    private readonly timer: ReturnType<typeof setInterval>;
    private isDrawing = false;
    /** When and for how long the components were last updated. */
    private drawn = { at: 0, took: 0 };
    /** The server's clock minus the browser's, in seconds. */
    private skew = 0;

    constructor(readonly name: string) {
        this.feed = new Feed(name, {
            loaded: (record) => {
                this.record = record;
                this.generation += 1;
                this.tick();
            },
            changed: (events) => {
                for (const listener of this.listeners) listener(events);
                this.draw();
            },
            connected: (connection) => (this.connection = connection),
        });
        void this.feed.start();
        api.root().then(
            ({ seconds }) => (this.skew = seconds - Date.now() / 1000),
            () => undefined,
        );
        this.timer = setInterval(() => {
            if (!document.hidden && !this.calm.isOver) this.tick();
        }, CALM_MS);
    }

    close(): void {
        clearInterval(this.timer);
        this.feed.close();
    }

    private tick(): void {
        this.calm = this.record;
        this.now = this.clock();
    }

    /** Requests the details of these sources until the returned function is called. */
    watch(sources: string[], listener: DetailListener): () => void {
        const key = Symbol('watch');
        this.watched.set(key, sources);
        this.listeners.add(listener);
        this.tellFeed();
        return () => {
            this.watched.delete(key);
            this.listeners.delete(listener);
            this.tellFeed();
        };
    }

    /** Microseconds since the run started, by the server's clock. */
    private clock(): number {
        const { info, isOver } = this.record;
        if (isOver) return info.last_at;
        const started = Date.parse(info.started_at) / 1000;
        const now = (Date.now() / 1000 + this.skew - started) * 1e6;
        return Number.isFinite(now) ? Math.max(now, info.last_at) : info.last_at;
    }

    private tellFeed(): void {
        // In one step, so that switching from one test to the next opens one stream.
        queueMicrotask(() =>
            this.feed.watch([...new Set([...this.watched.values()].flat())].sort()),
        );
    }

    private draw(): void {
        if (this.isDrawing) return;
        this.isDrawing = true;
        const done = () => {
            this.isDrawing = false;
            const begun = performance.now();
            this.record = this.record.view();
            if (this.record.isOver) this.tick();
            flushSync();
            this.drawn = { at: begun, took: performance.now() - begun };
        };
        // A hidden page gets no frames. In a visible page, most of the time is
        // the user's: expensive parts are drawn less often.
        const { at, took } = this.drawn;
        const next = at + Math.max(took * SHARE, BETWEEN_MS);
        const wait = Math.min(next - performance.now(), LATEST_MS);
        if (document.hidden) setTimeout(done, 250);
        else if (wait <= FRAME_MS) requestAnimationFrame(done);
        else setTimeout(() => requestAnimationFrame(done), wait - FRAME_MS);
    }
}
