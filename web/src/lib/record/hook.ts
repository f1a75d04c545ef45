// Applies events to a hook.

import type { Hook } from '../api-types';
import type { Event, HookPlanned } from '../event';
import { present } from '../present';

export function plannedHook(plan: HookPlanned): Hook {
    return { id: plan.hook, suite: plan.suite, name: plan.name, on: plan.on, runs: [] };
}

/** Applies an event of this hook. */
export function applyToHook(hook: Hook, event: Event): void {
    if (event.type === 'hook-started') {
        const { trigger, reason, test, at } = event;
        // Its output is loaded on demand.
        const run = { number: hook.runs.length + 1, started: at, trigger, reason, output: '' };
        hook.runs.push({ ...run, ...present({ test }) });
    } else if (event.type === 'hook-finished') {
        const run = hook.runs.at(-1);
        if (run === undefined) return;
        run.finished = event.at;
        if (event.problem != null) run.problem = event.problem;
    }
}

/** The problems of its runs. A run that has not finished has not failed yet. */
export function hookProblems(hook: Hook, isOver: boolean): string[] {
    return hook.runs.flatMap((run) => {
        const unfinished = isOver && run.finished === undefined;
        const problem = run.problem ?? (unfinished ? 'it did not come to its end' : undefined);
        return problem === undefined ? [] : [`hook \`${hook.name}\` on ${run.trigger}: ${problem}`];
    });
}
