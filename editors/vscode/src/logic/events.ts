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

type Events = {
    'run-started': { run: string; manifest?: { no_skips?: boolean } };
    'suite-planned': {
        suite: number;
        name: string;
        file: string;
        tolerates_collapse?: boolean;
        skips_fail?: boolean;
    };
    'fixture-planned': { fixture: number; suite: number; name: string };
    'hook-planned': { hook: number; suite: number; name: string };
    'test-planned': {
        test: number;
        suite: number;
        name: string;
        repetitions: number;
        timed?: boolean;
        expected?: ExpectedFailure | null;
    };
    warning: { diagnostic: { message: string; hint?: string | null } };
    'suite-waiting': { suite: number; lock: string; held_by: string };
    'fixture-starting': { fixture: number; attempt: number };
    'fixture-ready': { fixture: number };
    'fixture-collapsed': { fixture: number; reason: string };
    'fixture-stopped': { fixture: number; problem?: string | null };
    'fixture-broken': { fixture: number; reason: string };
    'hook-started': { hook: number; reason: string };
    'hook-finished': { hook: number; problem?: string | null };
    'test-started': { test: number; repetition: number; attempt: number };
    'test-phase': { test: number; phase: string };
    'test-stopping': { test: number; reason: string };
    'test-finished': {
        test: number;
        verdict: Verdict;
        reason?: string | null;
        rerun?: boolean;
    };
    'test-skipped': { test: number; reason: string };
    'test-repeated': { test: number; repetitions: number };
    'case-started': {
        test: number;
        case: number;
        name: string;
        parent?: number | null;
        location?: Location | null;
    };
    'case-finished': {
        test: number;
        case: number;
        verdict: Verdict;
        reason?: string | null;
        duration_us?: number | null;
        carried?: boolean;
    };
    message: { source: Source; test?: number | null; message: Message };
    measured: { test: number; measurement: Measurement };
    output: { source: Source; text: string };
    'stack-dumped': { source: Source; text: string };
    'run-finished': { interrupted?: string | null };
    'runner-died': { reason: string };
};

/** An event; `at` is in microseconds since the run started. */
export type RunEvent = {
    [Type in keyof Events]: { type: Type; at: number } & Events[Type];
}[keyof Events];

export type EventOf<Type extends RunEvent['type']> = Extract<RunEvent, { type: Type }>;

/** The fields that the extension reads, to compare them with schemas/event.json. */
export const REQUIRED_FIELDS: { [Type in keyof Events]: (keyof Events[Type] & string)[] } = {
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
};

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
