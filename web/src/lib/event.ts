// The vocabulary of a run, as in the event stream (spec/events.md).

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

/** The verdicts after which `rtf run --rerun failed` reruns a test. */
export const FAILED = [
    'failed',
    'error',
    'crashed',
    'timed-out',
    'collapsed',
] as const satisfies readonly Verdict[];

/** The state of a test for display: its verdict, or its progress. */
export type TestState = Verdict | 'running' | 'pending';

export const TEST_STATES: readonly TestState[] = [...VERDICTS, 'running', 'pending'];

/** A phase for display. */
export function phaseName(phase: Phase): string {
    return phase === 'setup' ? 'set-up' : phase;
}

/** Whether two sources are the same. */
export function isSame(a: Source, b: Source): boolean {
    return sourceKey(a) === sourceKey(b);
}

/** A source as a key: `test 3`. */
export function sourceKey(source: Source): string {
    if ('test' in source) return `test ${source.test}`;
    if ('fixture' in source) return `fixture ${source.fixture}`;
    return `hook ${source.hook}`;
}
