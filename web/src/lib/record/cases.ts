// The cases of one attempt of a test: pages of the server, and the events after them.

import type { Case, Parameter } from '../api-types';
import type { Event, Verdict } from '../event';
import { present } from '../present';

/** A case in the order of the tree, with the number of cases that contain it. */
export interface CaseRow {
    entry: Case;
    depth: number;
}

export class CaseList {
    private readonly byId = new Map<number, Case>();
    /** Announced cases that have not started. */
    notRun: readonly string[] = [];
    /** Number of passed cases that the server counts, but does not list. */
    omitted = 0;

    get size(): number {
        return this.byId.size;
    }

    get(id: number): Case | undefined {
        return this.byId.get(id);
    }

    /** Adds cases of a page; a case that finished in an event since then stays finished. */
    load(cases: readonly Case[], notRun: readonly string[] = [], omitted = 0): void {
        for (const each of cases) {
            if (this.byId.get(each.case)?.verdict === undefined) this.byId.set(each.case, each);
        }
        if (notRun.length > 0) this.notRun = notRun;
        this.omitted = Math.max(this.omitted, omitted);
    }

    /** Applies an event of the attempt. A page may include its effect. */
    apply(event: Event): void {
        switch (event.type) {
            case 'cases-planned': {
                const known = new Set([...this.notRun, ...this.topLevelNames()]);
                const added = event.names.filter((name) => !known.has(name));
                this.notRun = [...this.notRun, ...added];
                break;
            }
            case 'case-started': {
                if (event.parent == null && !event.earlier_attempts)
                    this.notRun = this.notRun.filter((name) => name !== event.name);
                if (!this.byId.has(event.case)) this.byId.set(event.case, this.started(event));
                break;
            }
            case 'case-finished': {
                const found = this.byId.get(event.case);
                if (found === undefined || found.verdict !== undefined) break;
                const episode = found.episode && {
                    ...found.episode,
                    ...present(event.episode ?? {}),
                };
                this.byId.set(event.case, {
                    ...found,
                    verdict: event.verdict,
                    duration_us: event.duration_us ?? event.at - found.started,
                    ...present({ carried: event.carried || null, reason: event.reason, episode }),
                });
                if (event.rerun) this.supersede(event.case);
                break;
            }
        }
    }

    /** A case and all cases that it contains. */
    within(id: number): ReadonlySet<number> {
        const ids = new Set([id]);
        // A case starts after the one that contains it, and has a larger id.
        for (const { case: each, parent } of this.inOrder())
            if (parent !== undefined && ids.has(parent)) ids.add(each);
        return ids;
    }

    /** The tree, each case before those that it contains. `fits` selects cases; the ones
     *  that contain a selected case are kept, too. */
    rows(fits: (entry: Case) => boolean = () => true): CaseRow[] {
        const children = new Map<number, Case[]>();
        const kept = new Set<number>();
        const all = this.inOrder();
        for (const entry of all) {
            const parent = this.parentOf(entry);
            const siblings = children.get(parent);
            if (siblings === undefined) children.set(parent, [entry]);
            else siblings.push(entry);
        }
        for (const entry of all.toReversed()) {
            if (!fits(entry) && !kept.has(entry.case)) continue;
            kept.add(entry.case);
            kept.add(this.parentOf(entry));
        }
        const rows: CaseRow[] = [];
        // A stack, because cases may nest deeply.
        const open: CaseRow[] = topFirst(children.get(TOP), 0);
        for (let row = open.pop(); row !== undefined; row = open.pop()) {
            if (!kept.has(row.entry.case)) continue;
            rows.push(row);
            open.push(...topFirst(children.get(row.entry.case), row.depth + 1));
        }
        return rows;
    }

    /** Another attempt of a case decides. */
    private supersede(id: number): void {
        for (const each of this.within(id)) {
            const found = this.byId.get(each);
            if (found !== undefined) this.byId.set(each, { ...found, superseded: true });
        }
    }

    /** Number of finished cases by verdict, without those that are not listed. Of a case that
     *  its framework ran again, the last attempt counts. */
    counts(): Partial<Record<Verdict, number>> {
        const counts: Partial<Record<Verdict, number>> = {};
        for (const { verdict, superseded } of this.byId.values())
            if (verdict !== undefined && !superseded) counts[verdict] = (counts[verdict] ?? 0) + 1;
        return counts;
    }

    private inOrder(): Case[] {
        return [...this.byId.values()].sort((a, b) => a.case - b.case);
    }

    private parentOf({ parent }: Case): number {
        return parent !== undefined && this.byId.has(parent) ? parent : TOP;
    }

    private topLevelNames(): string[] {
        return [...this.byId.values()].flatMap(({ name, parent }) =>
            parent === undefined ? [name] : [],
        );
    }

    private started(event: Extract<Event, { type: 'case-started' }>): Case {
        const { case: id, name, parent, parameters, tags, at } = event;
        const location = event.location as Case['location'];
        const earlier_attempts = event.earlier_attempts || null;
        const episode = event.episode && { seed: 0, ...event.episode };
        const above = parent == null ? undefined : this.byId.get(parent);
        return {
            case: id,
            name,
            path: above === undefined ? name : `${above.path}/${name}`,
            started: at,
            ...present({ parent, earlier_attempts, parameters, tags, location, episode }),
        };
    }
}

/** Cases are counted from 1. */
const TOP = 0;

/** Rows for a stack: the first one is taken first. */
function topFirst(cases: readonly Case[] | undefined, depth: number): CaseRow[] {
    return (cases ?? []).map((entry) => ({ entry, depth })).reverse();
}

/** Parameters on one line: `joint=0, speed=slow`. */
export function parameterText(parameters: readonly Parameter[] | undefined): string {
    return (parameters ?? []).map(({ name, value }) => `${name}=${value}`).join(', ');
}
