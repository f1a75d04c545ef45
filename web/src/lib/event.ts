// The vocabulary of a run, as the event stream has it (spec/events.md).

import type { Event } from '../generated/event';

export type {
    Attachment,
    Comparison,
    Diagnostic,
    Event,
    FixturePlanned,
    HookPlanned,
    LeakedProcess,
    Measurement,
    Message,
    Output,
    SuitePlanned,
    SuitePrepared,
    TestFinished,
    TestPlanned,
    RunStarted,
} from '../generated/event';

export type Verdict = Extract<Event, { type: 'test-finished' }>['verdict'];
export type Phase = Extract<Event, { type: 'test-phase' }>['phase'];
export type Trigger = Extract<Event, { type: 'hook-started' }>['trigger'];
export type Source = Extract<Event, { type: 'output' }>['source'];

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

/** The verdicts for which a test is run again, as `rtf run --rerun failed` has them. */
export const FAILED = [
    'failed',
    'error',
    'crashed',
    'timed-out',
    'collapsed',
] as const satisfies readonly Verdict[];

/** What a test looks like from outside: its verdict, or how far it is. */
export type TestState = Verdict | 'running' | 'pending';

export const TEST_STATES: readonly TestState[] = [...VERDICTS, 'running', 'pending'];

/** A phase as people say it. */
export function phaseName(phase: Phase): string {
    return phase === 'setup' ? 'set-up' : phase;
}

/** Whether one source is another. */
export function isSame(a: Source, b: Source): boolean {
    return sourceKey(a) === sourceKey(b);
}

/** A source as a text that can be compared: `test 3`. */
export function sourceKey(source: Source): string {
    if ('test' in source) return `test ${source.test}`;
    if ('fixture' in source) return `fixture ${source.fixture}`;
    return `hook ${source.hook}`;
}
