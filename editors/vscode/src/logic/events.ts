// The events of a run that the extension reads (spec/events.md), with the fields that it
// uses. Other events and fields are ignored.

import type { Location } from './list';

export type Verdict =
    | 'passed'
    | 'failed'
    | 'error'
    | 'crashed'
    | 'timed-out'
    | 'collapsed'
    | 'skipped'
    | 'interrupted';

export interface ExpectedFailure {
    verdicts: Verdict[];
    issue?: string | null;
    reason?: string | null;
    quarantined?: boolean;
    expired?: boolean;
}

export interface Comparison {
    expected: (number | null)[];
    got: (number | null)[];
}

export interface Message {
    kind: 'report' | 'check' | 'failure' | 'error';
    text: string;
    location?: Location | null;
    comparison?: Comparison | null;
    case?: number | null;
}

export interface Measurement {
    name: string;
    value: number | null;
    unit: string;
    low?: number | null;
    high?: number | null;
    location?: Location | null;
    case?: number | null;
}

export type Source = { test?: number; fixture?: number; hook?: number };

/** The types of the fields. */
interface Fields {
    run: string;
    manifest?: { no_skips?: boolean };
    suite: number;
    fixture: number;
    hook: number;
    test: number;
    case: number;
    parent?: number | null;
    source: Source;
    name: string;
    file: string;
    location?: Location | null;
    tolerates_collapse?: boolean;
    skips_fail?: boolean;
    expected?: ExpectedFailure | null;
    repetitions: number;
    timed?: boolean;
    repetition: number;
    attempt: number;
    phase: string;
    verdict: Verdict;
    reason: string;
    rerun?: boolean;
    carried?: boolean;
    duration_us?: number | null;
    diagnostic: { message: string; hint?: string | null };
    message: Message;
    measurement: Measurement;
    text: string;
    lock: string;
    held_by: string;
    problem?: string | null;
    interrupted?: string | null;
}

/** Fields that other events always have. */
interface Exceptions {
    'test-finished': { reason?: string | null };
    'case-finished': { reason?: string | null };
    message: { test?: number | null };
}

/** The fields that the extension reads, to compare them with schemas/event.json. */
export const REQUIRED_FIELDS = {
    'run-started': ['run', 'manifest'],
    'suite-planned': ['suite', 'name', 'file', 'tolerates_collapse', 'skips_fail'],
    'fixture-planned': ['fixture', 'suite', 'name'],
    'hook-planned': ['hook', 'suite', 'name'],
    'test-planned': ['test', 'suite', 'name', 'repetitions', 'timed', 'expected'],
    warning: ['diagnostic'],
    'suite-waiting': ['suite', 'lock', 'held_by'],
    'fixture-starting': ['fixture', 'attempt'],
    'fixture-ready': ['fixture'],
    'fixture-collapsed': ['fixture', 'reason'],
    'fixture-stopped': ['fixture', 'problem'],
    'fixture-broken': ['fixture', 'reason'],
    'hook-started': ['hook', 'reason'],
    'hook-finished': ['hook', 'problem'],
    'test-started': ['test', 'repetition', 'attempt'],
    'test-phase': ['test', 'phase'],
    'test-stopping': ['test', 'reason'],
    'test-finished': ['test', 'verdict', 'reason', 'rerun'],
    'test-skipped': ['test', 'reason'],
    'test-repeated': ['test', 'repetitions'],
    'case-started': ['test', 'case', 'name', 'parent', 'location'],
    'case-finished': ['test', 'case', 'verdict', 'reason', 'duration_us', 'carried'],
    message: ['source', 'test', 'message'],
    measured: ['test', 'measurement'],
    output: ['source', 'text'],
    'stack-dumped': ['source', 'text'],
    'run-finished': ['interrupted'],
    'runner-died': ['reason'],
} as const satisfies Record<string, (keyof Fields)[]>;

type EventType = keyof typeof REQUIRED_FIELDS;
type FieldsOf<Type extends EventType> = Pick<Fields, (typeof REQUIRED_FIELDS)[Type][number]>;

/** An event; `at` is in microseconds since the run started. */
export type RunEvent = {
    [Type in EventType]: { type: Type; at: number } & (Type extends keyof Exceptions
        ? Omit<FieldsOf<Type>, keyof Exceptions[Type]> & Exceptions[Type]
        : FieldsOf<Type>);
}[EventType];

export type EventOf<Type extends EventType> = Extract<RunEvent, { type: Type }>;

/** Parses a line of the stream; returns nothing for other text and unknown events. */
export function parseEvent(line: string): RunEvent | undefined {
    if (!line.startsWith('{')) return undefined;
    try {
        const event = JSON.parse(line) as RunEvent;
        return event.type in REQUIRED_FIELDS ? event : undefined;
    } catch {
        return undefined;
    }
}
