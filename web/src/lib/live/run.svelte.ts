// The run that is shown, for components. Ten thousand tests are too many to
// watch each field of each of them: the record is plain data, and once a frame
// there is a new view of it when something has changed. What is taken out of the
// record keeps its identity while it changes; components copy what they show.

import { flushSync } from 'svelte';
import * as api from '../api';
import type { Signal } from '../api-types';
import type { Event } from '../event';
import type { ListName, Lists } from '../record/detail';
import { RunRecord } from '../record/record';
import { Feed, type Connection } from './feed';

/** What was loaded of one attempt, start or run. */
export interface Kept {
    lists: Lists;
    more: Partial<Record<ListName, number>>;
    signals: readonly Signal[];
}

/** What of so many of them is kept. */
const KEPT = 30;

/** Gets what came in, as long as it wants to. */
export type DetailListener = (events: Event[]) => void;

const FRAME_MS = 16;
/** The least time between two draws: who looks does not see more, and the tests need the time. */
const BETWEEN_MS = 100;
/** A draw may take one part in this many of the time. */
const SHARE = 5;
/** Nothing waits longer than this to be drawn. */
const LATEST_MS = 120;
/** How often that is drawn which is only looked at now and then. */
const CALM_MS = 500;

export class LiveRun {
    readonly name: string;
    connection: Connection = $state.raw({ kind: 'loading' });
    /** What is known, another object after each change. */
    record: RunRecord = $state.raw(new RunRecord());
    /** The same, but not every change: for what is long to draw. */
    calm: RunRecord = $state.raw(new RunRecord());
    /** Microseconds since the run started, as of `calm`. */
    now = $state(0);
    /** The moment that is shown in the time line, in microseconds since the run's start. */
    moment: number | null = $state(null);
    /** Grows with each new record: what was loaded beside it is old. */
    generation = $state(0);
    /** What was loaded of attempts, starts and hook runs: it stays when the server goes. */
    readonly kept = new Map<string, Kept>();
    private readonly feed: Feed;
    private readonly listeners = new Set<DetailListener>();
    private readonly watched = new Map<symbol, string[]>();
    private readonly timer: ReturnType<typeof setInterval>;
    private isDrawing = false;
    /** When and for how long the components were last brought up to date. */
    private drawn = { at: 0, took: 0 };
    /** The server's clock minus the browser's, in seconds. */
    private skew = 0;

    constructor(name: string) {
        this.name = name;
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

    /** Keeps what was loaded; what was not looked at for longest is forgotten. */
    keep(key: string, kept: Kept): void {
        this.kept.delete(key);
        this.kept.set(key, kept);
        for (const old of this.kept.keys()) {
            if (this.kept.size <= KEPT) break;
            this.kept.delete(old);
        }
    }

    private tick(): void {
        this.calm = this.record;
        this.now = this.clock();
    }

    /** Asks for the details of these sources until the answer is called. */
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
        // Together, so that going from one test to the next opens one stream.
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
        // A page in the background gets no frames. In sight, most of the time is
        // the reader's: what is long to draw is drawn less often.
        const { at, took } = this.drawn;
        const next = at + Math.max(took * SHARE, BETWEEN_MS);
        const wait = Math.min(next - performance.now(), LATEST_MS);
        if (document.hidden) setTimeout(done, 250);
        else if (wait <= FRAME_MS) requestAnimationFrame(done);
        else setTimeout(() => requestAnimationFrame(done), wait - FRAME_MS);
    }
}
