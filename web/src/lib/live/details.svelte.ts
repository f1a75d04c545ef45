// Loads the details of one attempt of a test, one start of a fixture or one run of a hook,
// and keeps them up to date while the run continues.

import { get, path } from '../api';
import type { Asked, Cases, Questions, Said, Signal, Signals } from '../api-types';
import type { Event } from '../event';
import { CaseList } from '../record/cases';
import { addToLists, append, emptyLists, LIST_NAMES, type ListName } from '../record/detail';
import type { LiveRun } from './run.svelte';

export interface Subject {
    kind: 'test' | 'fixture' | 'hook';
    id: number;
    /** The number of the attempt, start or run, from 1. */
    number: number;
}

/** Fixtures and hooks have only these lists. */
const LISTS: Record<Subject['kind'], readonly ListName[]> = {
    test: LIST_NAMES,
    fixture: ['messages', 'output'],
    hook: ['messages', 'output'],
};

const PARTS = { test: 'attempts', fixture: 'starts', hook: 'runs' } as const;

/** Pages that are loaded without a click: 5000 entries, 5 MB of output. */
const FIRST_PAGES = 5;
const PAGE = 1000;
/** Growing curves are reloaded after this time. */
const SIGNALS_EVERY = 1000;

type Page = { next?: number; omitted?: number } & { [list in ListName]?: Said[] };

export class Details {
    /** Incremented with each change of the lists. */
    version = $state(0);
    isLoading = $state(true);
    /** Whether all pages have been loaded. */
    isLoaded = $state(false);
    problem: string | null = $state(null);
    /** Lists with more pages on the server, and where they continue. */
    more: Partial<Record<ListName, number>> = $state.raw({});
    /** Numbers of entries that a report omits. */
    omitted: Partial<Record<ListName, number>> = $state.raw({});
    /** The signals of a test. */
    signals: readonly Signal[] = $state.raw([]);
    /** The questions of a test to an operator. */
    questions: readonly Asked[] = $state.raw([]);
    /** The cases of a test. */
    cases = new CaseList();
    /** Where the next page of cases starts, if there is one. */
    nextCase: number | null = $state(null);
    private signalsDue: ReturnType<typeof setTimeout> | null = null;
    private all = emptyLists();
    private waiting: Event[] | null = [];
    private latest: number;
    private readonly closing = new AbortController();
    private readonly unwatch: () => void;

    constructor(
        private readonly run: LiveRun,
        readonly subject: Subject,
    ) {
        this.latest = this.known();
        const source = `${subject.kind}:${subject.id}`;
        // Subscribe, then load: events in between are in both and are dropped once.
        this.unwatch = run.watch(run.record.isOver ? [] : [source], (events) =>
            this.receive(events),
        );
        void this.load();
    }

    get lists() {
        // eslint-disable-next-line @typescript-eslint/no-unused-expressions
        this.version;
        return this.all;
    }

    close(): void {
        this.closing.abort();
        if (this.signalsDue !== null) clearTimeout(this.signalsDue);
        this.unwatch();
    }

    /** Loads the next page of a list. */
    async loadMore(list: ListName): Promise<void> {
        const after = this.more[list];
        if (after === undefined) return;
        await this.attempt(() => this.pages(list, after, 1));
    }

    /** Loads the next page of cases. */
    async loadMoreCases(): Promise<void> {
        const after = this.nextCase;
        if (after === null) return;
        await this.attempt(() => this.casePages(after, 1));
    }

    private async casePages(from: number | undefined, most: number): Promise<void> {
        const { id, number } = this.subject;
        const route = ['runs', this.run.name, 'tests', id, 'attempts', number, 'cases'];
        let after = from;
        for (let page = 0; page < most; page += 1) {
            const query = path(route, { after, limit: PAGE });
            const { cases, next, omitted, not_run } = await get<Cases>(query, this.closing.signal);
            this.cases.load(cases, not_run, omitted);
            after = next;
            this.version += 1;
            if (after === undefined) break;
        }
        this.nextCase = after ?? null;
    }

    private get key(): string {
        const { kind, id, number } = this.subject;
        return `${kind}/${id}/${number}`;
    }

    private async load(): Promise<void> {
        const loaded = await this.attempt(async () => {
            const { kind } = this.subject;
            await Promise.all([
                ...LISTS[kind].map((list) => this.pages(list, undefined, FIRST_PAGES)),
                ...(kind === 'test'
                    ? [
                          this.loadSignals(),
                          this.loadQuestions(),
                          this.casePages(undefined, FIRST_PAGES),
                      ]
                    : []),
            ]);
            const missed = this.waiting ?? [];
            this.waiting = null;
            missed.forEach((event) => this.add(event));
        });
        this.isLoading = false;
        if (loaded) this.keep();
        else this.restore();
        this.isLoaded ||= loaded;
    }

    private keep(): void {
        const { all: lists, more, signals, questions, cases } = this;
        this.run.kept.set(this.key, { lists, more, signals, questions, cases });
    }

    /** Restores details that were loaded before. */
    private restore(): void {
        const kept = this.run.kept.get(this.key);
        if (kept === undefined || this.closing.signal.aborted) return;
        this.all = kept.lists;
        this.more = kept.more;
        this.signals = kept.signals;
        this.questions = kept.questions;
        this.cases = kept.cases;
        this.isLoaded = true;
        this.problem = null;
        this.version += 1;
    }

    private async loadSignals(): Promise<void> {
        const { id, number } = this.subject;
        const route = ['runs', this.run.name, 'tests', id, 'attempts', number, 'series'];
        this.signals = (await get<Signals>(path(route), this.closing.signal)).series;
        const kept = this.run.kept.get(this.key);
        if (kept !== undefined) kept.signals = this.signals;
    }

    private async loadQuestions(): Promise<void> {
        const { id, number } = this.subject;
        const route = ['runs', this.run.name, 'tests', id, 'attempts', number, 'questions'];
        this.questions = (await get<Questions>(path(route), this.closing.signal)).questions;
        const kept = this.run.kept.get(this.key);
        if (kept !== undefined) kept.questions = this.questions;
    }

    private renewSignals(): void {
        this.signalsDue ??= setTimeout(() => {
            this.signalsDue = null;
            void this.attempt(() => this.loadSignals());
        }, SIGNALS_EVERY);
    }

    /** Whether it succeeded. */
    private async attempt(work: () => Promise<void>): Promise<boolean> {
        let isDone = false;
        try {
            await work();
            this.problem = null;
            isDone = true;
        } catch (problem) {
            if (this.closing.signal.aborted) return false;
            this.problem = problem instanceof Error ? problem.message : String(problem);
        }
        this.version += 1;
        return isDone;
    }

    private async pages(list: ListName, from: number | undefined, most: number): Promise<void> {
        const { kind, id, number } = this.subject;
        const route = ['runs', this.run.name, `${kind}s`, id, PARTS[kind], number, list];
        let after = from;
        for (let page = 0; page < most; page += 1) {
            const answer = await get<Page>(
                path(route, { after, limit: PAGE }),
                this.closing.signal,
            );
            const entries = this.all[list] as Said[];
            for (const entry of answer[list] ?? []) append(entries, entry);
            if (answer.omitted !== undefined)
                this.omitted = { ...this.omitted, [list]: answer.omitted };
            after = answer.next;
            this.version += 1;
            if (after === undefined) break;
        }
        const more = { ...this.more };
        if (after === undefined) delete more[list];
        else more[list] = after;
        this.more = more;
    }

    private receive(events: Event[]): void {
        let isChanged = false;
        for (const event of events) {
            if (!this.isOurs(event)) continue;
            if (event.type === 'sampled') this.renewSignals();
            else if (isOfQuestion(event)) void this.attempt(() => this.loadQuestions());
            else if (this.waiting !== null) this.waiting.push(event);
            else this.add(event);
            isChanged = true;
        }
        if (isChanged) this.version += 1;
    }

    /** Whether an event is about the subject, and about this attempt of it. */
    private isOurs(event: Event): boolean {
        const { kind, id, number } = this.subject;
        if (event.type === 'test-started' && kind === 'test' && event.test === id) this.latest += 1;
        if (event.type === 'fixture-starting' && kind === 'fixture' && event.fixture === id) {
            this.latest = event.attempt;
        }
        if (event.type === 'hook-started' && kind === 'hook' && event.hook === id) this.latest += 1;
        if (this.latest !== number) return false;
        // A fixture's report about a test is shown with the test.
        if (event.type === 'message' && event.test != null)
            return kind === 'test' && event.test === id;
        if ('source' in event) return (event.source as Record<string, number>)[kind] === id;
        return kind === 'test' && 'test' in event && event.test === id;
    }

    private add(event: Event): void {
        this.cases.apply(event);
        const list = listOf(event);
        // Appending to an incomplete list would leave a gap.
        if (list !== null && this.more[list] === undefined)
            addToLists(this.all, event, this.run.name);
    }

    private known(): number {
        const { kind, id } = this.subject;
        const { tests, fixtures, hooks } = this.run.record;
        if (kind === 'test') return tests[id]?.attempts.length ?? 0;
        if (kind === 'fixture') return fixtures[id]?.starts.at(-1)?.number ?? 0;
        return hooks[id]?.runs.length ?? 0;
    }
}

function isOfQuestion({ type }: Event): boolean {
    return type === 'question-asked' || type === 'question-closed';
}

function listOf(event: Event): ListName | null {
    switch (event.type) {
        case 'message':
            return 'messages';
        case 'measured':
            return 'measurements';
        case 'attached':
            return 'attachments';
        case 'stack-dumped':
            return 'stacks';
        case 'output':
            return 'output';
        default:
            return null;
    }
}
