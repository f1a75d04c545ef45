// What the events of a hook make of it.

import type { Hook } from '../api-types';
import type { Event, HookPlanned } from '../event';

export function plannedHook(plan: HookPlanned): Hook {
    return { id: plan.hook, suite: plan.suite, name: plan.name, on: plan.on, runs: [] };
}

/** Takes in an event of this hook. */
export function applyToHook(hook: Hook, event: Event): void {
    if (event.type === 'hook-started') {
        const { trigger, reason, test, at } = event;
        const about = test == null ? {} : { test };
        // What it prints is left to whoever looks at it.
        const run = { number: hook.runs.length + 1, started: at, trigger, reason, output: '' };
        hook.runs.push({ ...run, ...about });
    } else if (event.type === 'hook-finished') {
        const run = hook.runs.at(-1);
        if (run === undefined) return;
        run.finished = event.at;
        if (event.problem != null) run.problem = event.problem;
    }
}

/** Runs that did not do their work, in words. One that runs has not failed yet. */
export function hookProblems(hook: Hook, isOver: boolean): string[] {
    return hook.runs.flatMap((run) => {
        const unfinished = isOver && run.finished === undefined;
        const problem = run.problem ?? (unfinished ? 'it did not come to its end' : undefined);
        return problem === undefined ? [] : [`hook \`${hook.name}\` on ${run.trigger}: ${problem}`];
    });
}
