// The objects of the web API, version 1 (spec/web.md), from its description,
// and the page's additions while it follows a run.

import type * as api from '../generated/api';

export type * from '../generated/api';
export type {
    Attached as AttachmentEntry,
    Measured as MeasurementEntry,
    Printed as OutputEntry,
    Said as MessageEntry,
    Server as ApiRoot,
    Stack as StackEntry,
    State as RunStateName,
} from '../generated/api';

/** An entry in a list of an attempt: an event's number, time and content. */
export type Said = Pick<api.Said, 'seq' | 'at'>;

export interface AttemptRow extends api.AttemptRow {
    /** Known only for attempts that ended while the page was open. */
    reason?: string;
    /** Whether it was being stopped; known only for attempts since the page was opened. */
    stopped?: boolean;
}

export interface Test extends api.Test {
    attempts: AttemptRow[];
}

export interface Snapshot extends api.Snapshot {
    tests: Test[];
}
