// The objects of the web API, version 1 (spec/web.md), from its description,
// and the page's additions while it follows a run.

import type * as api from '../generated/api';

export type {
    Asked,
    Attached as AttachmentEntry,
    Case,
    Cases,
    Counts,
    Fixture,
    Hook,
    Measured as MeasurementEntry,
    Printed as OutputEntry,
    Questions,
    Parameter,
    ProvidedValue,
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

export type Attempt = api.Attempt & {
    /** Why it is being stopped. */
    stopping?: string;
};
