// The vocabulary of a run, as in the event stream (spec/events.md).

import type { Event, Verdict } from '../generated/event';
import type { Totals } from './api-types';

export type * from '../generated/event';

export type Phase = Extract<Event, { type: 'test-phase' }>['phase'];

/** Every verdict, in the order in which summaries list them. */
export const VERDICTS = [
    'passed',
    'failed',
    'error',
    'crashed',
    'timed-out',
    'collapsed',
    'skipped',
    'interrupted',
] as const satisfies readonly Verdict[];

/** The state of a test for display: its verdict, or its progress. */
export type TestState = Verdict | 'running' | 'pending';

export const TEST_STATES: readonly TestState[] = [...VERDICTS, 'running', 'pending'];

/** A phase for display. */
export function phaseName(phase: Phase): string {
    return phase === 'setup' ? 'set-up' : phase;
}

/** The number of tests in this state. */
export function testsIn(state: TestState, totals: Totals): number {
    return state === 'running' || state === 'pending' ? totals[state] : totals.verdicts[state];
}
