// The duration of each phase of an attempt.

import type { Attempt } from './api-types';
import { phaseName } from './event';

/** All phases from the start of the attempt on: it starts with loading the plug-in. Each took
 *  microseconds; `null` while it lasts. */
export function phaseTimes(started: number, phases: Attempt['phases'], finished: number | null) {
    const begins = phases.map(({ phase, at }) => ({ name: phaseName(phase), at }));
    const first = begins[0];
    if (first === undefined || first.at > started) begins.unshift({ name: 'load', at: started });
    // An empty phase between two of one name is one phase.
    const joined = begins.filter(({ name }, index) => begins[index - 1]?.name !== name);
    return joined.map(({ name, at }, index) => {
        const to = joined[index + 1]?.at ?? finished;
        return { name, took: to === null ? null : to - at };
    });
}

/** Start of the set-up, in microseconds after the start of the attempt: the zero of the plug-in's clock. */
export function setUpAfter(started: number, phases: Attempt['phases']): number {
    const setUp = phases.find(({ phase }) => phase === 'setup') ?? phases[0];
    return setUp === undefined ? 0 : setUp.at - started;
}
