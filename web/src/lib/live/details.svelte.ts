// Loads the details of one attempt of a test, one start of a fixture or one run of a hook,
// and keeps them up to date while the run continues.

import { get, path, type Query } from '../api';
import type { Asked, Cases, Questions, Said, Signal, Signals } from '../api-types';
import type { Event } from '../event';
import { Task } from '../task.svelte';
import { CaseList } from '../record/cases';
import {
    addToLists,
    append,
    emptyLists,
    LIST_NAMES,
    LIST_OF,
    type ListName,
} from '../record/detail';
import type { LiveRun } from './run.svelte';

export interface Subject {
    kind: 'test' | 'fixture' | 'hook';
    id: number;
    /** The number of the attempt, start or run, from 1. */
    number: number;
    /** Of an attempt, only this case and those that it contains. */
    case?: number;
}

/** What is reported in a case. */
const CASE_LISTS: readonly ListName[] = ['messages', 'measurements', 'attachments'];

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

/** What is loaded. It stays when the server exits. */
export class Content {
    lists = emptyLists();
    cases = new CaseList();
    /** Lists with more pages on the server, and where they continue. */
    more: Partial<Record<ListName | 'cases', number>> = {};
    /** Numbers of entries that a report omits. */
    omitted: Partial<Record<ListName, number>> = {};
    /** The signals of a test. */
    signals: readonly Signal[] = [];
    /** The questions of a test to an operator. */
    questions: readonly Asked[] = [];
}

type Page = Partial<Cases> & { [list in ListName]?: Said[] };

export class Details {
    /** Incremented with each change of the content. */
    version = $state(0);
    isLoading = $state(true);
    /** Whether all pages have been loaded. */
    isLoaded = $state(false);
    readonly task = new Task();
    private all = new Content();
    private signalsDue: ReturnType<typeof setTimeout> | null = null;
    private waiting: Event[] | null = [];
    private latest: number;
    private readonly key: string;
    private readonly closing = new AbortController();
    private readonly unwatch: () => void;

    constructor(
        private readonly run: LiveRun,
        readonly subject: Subject,
    ) {
        const { kind, id, number } = subject;
        this.key = `${kind}/${id}/${number}/${subject.case ?? ''}`;
        this.latest = this.known();
        // Subscribe, then load: events in between are in both and are dropped once.
        this.unwatch = run.watch(run.record.isOver ? [] : [`${kind}:${id}`], (events) =>
            this.receive(events),
        );
        void this.load();
    }

    /** The content, which changes in place. */
    get content(): Content {
        // eslint-disable-next-line @typescript-eslint/no-unused-expressions
        this.version;
        return this.all;
    }

    /** The route of the whole log. */
    get log(): (string | number)[] {
        const { kind, id, number } = this.subject;
        return ['runs', this.run.name, 'logs', `${kind}s`, id, number];
    }

    close(): void {
        this.closing.abort();
        if (this.signalsDue !== null) clearTimeout(this.signalsDue);
        this.unwatch();
    }

    /** Loads the next page of a list; `null` without one. */
    more(list: ListName | 'cases'): (() => Promise<unknown>) | null {
        const after = this.content.more[list];
        if (after === undefined) return null;
        return () => this.attempt(() => this.pages(list, after, 1));
    }

    private async load(): Promise<void> {
        const { kind, case: shown } = this.subject;
        const loaded = await this.attempt(async () => {
            const own = shown === undefined ? LISTS[kind] : CASE_LISTS;
            const lists = [...own, ...(kind === 'test' ? (['cases'] as const) : [])];
            await Promise.all([
                ...lists.map((list) => this.pages(list, undefined, FIRST_PAGES)),
                ...(kind === 'test' ? [this.loadSignals()] : []),
                ...(kind === 'test' && shown === undefined ? [this.loadQuestions()] : []),
            ]);
            const missed = this.waiting ?? [];
            this.waiting = null;
            for (const event of missed) if (this.isInCase(event)) this.add(event);
        });
        this.isLoading = false;
        if (loaded) this.run.kept.set(this.key, this.all);
        else this.restore();
        this.isLoaded ||= loaded;
    }

    /** Restores details that were loaded before. */
    private restore(): void {
        const kept = this.run.kept.get(this.key);
        if (kept === undefined || this.closing.signal.aborted) return;
        this.all = kept;
        this.isLoaded = true;
        this.task.problem = null;
        this.version += 1;
    }

    /** A part of the subject. */
    private part<T>(name: string, query: Query = {}): Promise<T> {
        const { kind, id, number, case: shown } = this.subject;
        const route = ['runs', this.run.name, `${kind}s`, id, PARTS[kind], number, name];
        return get<T>(path(route, { ...query, case: shown }), this.closing.signal);
    }

    private async loadSignals(): Promise<void> {
        this.all.signals = (await this.part<Signals>('series')).series;
        this.version += 1;
    }

    private async loadQuestions(): Promise<void> {
        this.all.questions = (await this.part<Questions>('questions')).questions;
        this.version += 1;
    }

    private renewQuestions(): void {
        if (this.subject.case === undefined) void this.attempt(() => this.loadQuestions());
    }

    private renewSignals(): void {
        this.signalsDue ??= setTimeout(() => {
            this.signalsDue = null;
            void this.attempt(() => this.loadSignals());
        }, SIGNALS_EVERY);
    }

    /** Whether it succeeded. */
    private async attempt(work: () => Promise<void>): Promise<boolean> {
        const isDone = await this.task.run(work, this.closing.signal);
        this.version += 1;
        return isDone;
    }

    private async pages(
        list: ListName | 'cases',
        from: number | undefined,
        most: number,
    ): Promise<void> {
        let after = from;
        for (let page = 0; page < most; page += 1) {
            const answer = await this.part<Page>(list, { after, limit: PAGE });
            this.addPage(list, answer);
            after = answer.next;
            this.version += 1;
            if (after === undefined) break;
        }
        if (after === undefined) delete this.all.more[list];
        else this.all.more[list] = after;
        this.version += 1;
    }

    private addPage(list: ListName | 'cases', page: Page): void {
        if (list === 'cases') {
            this.all.cases.load(page.cases ?? [], page.not_run, page.omitted);
            return;
        }
        for (const entry of page[list] ?? []) append(this.all.lists[list] as Said[], entry);
        if (page.omitted !== undefined) this.all.omitted[list] = page.omitted;
    }

    private receive(events: Event[]): void {
        let isChanged = false;
        for (const event of events) {
            if (!this.isOurs(event)) continue;
            // Which cases the shown one contains is known when they are loaded.
            const isKnown = this.waiting === null;
            if (isKnown && !this.isInCase(event)) continue;
            if (event.type === 'sampled') this.renewSignals();
            else if (isOfQuestion(event)) this.renewQuestions();
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

    /** Whether an event is about the shown case or one that it contains. */
    private isInCase(event: Event): boolean {
        const { case: shown } = this.subject;
        if (shown === undefined) return true;
        const found = caseOf(event);
        return found != null && this.all.cases.within(shown).has(found);
    }

    private add(event: Event): void {
        const { cases, lists, more } = this.all;
        cases.apply(event);
        const list = LIST_OF[event.type];
        // Appending to an incomplete list would leave a gap.
        if (list !== undefined && more[list] === undefined) addToLists(lists, event, this.run.name);
    }

    private known(): number {
        const { kind, id } = this.subject;
        const { tests, fixtures, hooks } = this.run.record;
        if (kind === 'test') return tests[id]?.attempts.length ?? 0;
        if (kind === 'fixture') return fixtures[id]?.starts.at(-1)?.number ?? 0;
        return hooks[id]?.runs.length ?? 0;
    }
}

/** The case in which an event was reported, or that starts in it, or that finishes. */
function caseOf(event: Event): number | null | undefined {
    switch (event.type) {
        case 'message':
            return event.message.case;
        case 'measured':
            return event.measurement.case;
        case 'sampled':
            return event.samples.case;
        case 'attached':
            return event.attachment.case;
        case 'case-started':
            return event.parent;
        case 'case-finished':
            return event.case;
        default:
            return null;
    }
}

function isOfQuestion({ type }: Event): boolean {
    return type === 'question-asked' || type === 'question-closed';
}
