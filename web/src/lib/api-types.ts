// The objects of the web API, version 1 (spec/web.md).

import type {
    Attachment,
    Diagnostic,
    LeftProcess,
    Measurement,
    Message,
    Output,
    Phase,
    TestFinished,
    Trigger,
    Verdict,
} from './event';

export interface ApiRoot {
    api: number;
    rtf: string;
    mode: 'run' | 'serve';
    current?: string;
    control: boolean;
    authorised: boolean;
    token_to_read: boolean;
    seconds: number;
}

export interface Totals {
    planned: number;
    pending: number;
    running: number;
    done: number;
    verdicts: Record<Verdict, number>;
}

export type RunStateName = 'running' | 'finished' | 'interrupted' | 'died' | 'incomplete';

export interface RunInfo {
    run: string;
    started_at: string;
    rtf: string;
    command: string[];
    folder: string;
    state: RunStateName;
    interrupted?: string;
    died?: string;
    green?: boolean;
    /** The number of the next event. */
    seq: number;
    last_at: number;
    suites: number;
    bytes: number;
    totals: Totals;
    problems: string[];
    damages: { line: number; problem: string }[];
}

export interface Suite {
    id: number;
    name: string;
    file: string;
    description: string;
    environment: string;
    tolerates_collapse?: boolean;
    state: 'pending' | 'running' | 'finished';
    started?: number;
    finished?: number;
    totals: Totals;
    problems: string[];
    fixtures: number[];
    hooks: number[];
}

export type FixtureState =
    'pending' | 'starting' | 'ready' | 'collapsed' | 'stopping' | 'stopped' | 'broken';

export interface Start {
    number: number;
    starting: number;
    ready?: number;
    collapsed?: { at: number; reason: string };
    stopping?: number;
    stopped?: number;
    problem?: string;
}

export interface Fixture {
    id: number;
    suite: number;
    name: string;
    plugin_type: string;
    state: FixtureState;
    starts: Start[];
    broken?: string;
    log_tail?: string[];
    messages?: Message[];
    left?: LeftProcess[];
}

export interface HookRun {
    number: number;
    started: number;
    finished?: number;
    trigger: Trigger;
    reason: string;
    test?: number;
    problem?: string;
    output?: string;
    messages?: Message[];
    stacks?: string[];
    left?: LeftProcess[];
}

export interface Hook {
    id: number;
    suite: number;
    name: string;
    on: Trigger[];
    runs: HookRun[];
}

export interface Counts {
    messages: number;
    failures: number;
    measurements: number;
    violations: number;
    attachments: number;
    output_bytes: number;
}

export interface AttemptRow {
    number: number;
    repetition: number;
    attempt: number;
    started: number;
    finished?: number;
    verdict?: Verdict;
    rerun?: boolean;
    /** Known only of attempts that ended while the page looked. */
    reason?: string;
}

export interface Test {
    id: number;
    suite: number;
    name: string;
    plugin_type: string;
    plugin: string;
    repetitions: number;
    /** It is repeated until a time is over; `repetitions` is then that of a round. */
    timed?: boolean;
    tags?: string[];
    state: 'pending' | 'running' | 'done';
    verdict?: Verdict;
    reason?: string;
    phase?: Phase;
    duration_us: number;
    slow?: boolean;
    attempts: AttemptRow[];
    counts: Counts;
}

export interface Snapshot {
    info: RunInfo;
    suites: Suite[];
    fixtures: Fixture[];
    hooks: Hook[];
    tests: Test[];
    warnings: Diagnostic[];
    left: LeftProcess[];
}

export interface Attempt extends AttemptRow {
    phases: { phase: Phase; at: number }[];
    phase?: Phase;
    exit?: NonNullable<TestFinished['exit']>;
    slow?: boolean;
    stopping?: string;
    counts: Counts;
    left?: LeftProcess[];
}

/** What the lists of an attempt hold: an event's number, its time, its content. */
export interface Said {
    seq: number;
    at: number;
}
export interface MessageEntry extends Said {
    message: Message;
}
export interface MeasurementEntry extends Said {
    measurement: Measurement;
    within: boolean;
}
export interface AttachmentEntry extends Said {
    attachment: Attachment;
    url: string;
}
export interface StackEntry extends Said {
    text: string;
}
export interface OutputEntry extends Said {
    stream: Output['stream'];
    text: string;
    omitted?: number;
}
