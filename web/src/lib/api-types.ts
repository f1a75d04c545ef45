// The objects of the web API, version 1 (spec/web.md), as its description has
// them, and what the page makes of them while it follows a run.

import type * as api from '../generated/api';

export type {
    Attached as AttachmentEntry,
    Counts,
    Fixture,
    Hook,
    Measured as MeasurementEntry,
    Printed as OutputEntry,
    Said as MessageEntry,
    Server as ApiRoot,
    Stack as StackEntry,
    Signal,
    Signals,
    Start,
    Started,
    State as RunStateName,
    RunInfo,
    Suite,
    Totals,
} from '../generated/api';

/** What the lists of an attempt hold: an event's number, its time, its content. */
export type Said = Pick<api.Said, 'seq' | 'at'>;

export interface AttemptRow extends api.AttemptRow {
    /** Known only of attempts that ended while the page looked. */
    reason?: string;
}

export interface Test extends api.Test {
    attempts: AttemptRow[];
}

export interface Snapshot extends api.Snapshot {
    tests: Test[];
}

export type Attempt = api.Attempt & {
    /** Why it is being stopped, while it is. */
    stopping?: string;
};
