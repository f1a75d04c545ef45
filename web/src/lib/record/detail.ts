// The details of one attempt of a test, one start of a fixture or one run of a hook:
// the pages from the server, and later events.

import type {
    AttachmentEntry,
    MeasurementEntry,
    MessageEntry,
    OutputEntry,
    Said,
    StackEntry,
} from '../api-types';
import { address } from '../api';
import type { Event, Measurement } from '../event';
import { present } from '../present';

export interface Lists {
    messages: MessageEntry[];
    measurements: MeasurementEntry[];
    attachments: AttachmentEntry[];
    stacks: StackEntry[];
    output: OutputEntry[];
}

export type ListName = keyof Lists;

/** The lists to which events add entries. */
export const LIST_OF: { [type in Event['type']]?: ListName } = {
    message: 'messages',
    measured: 'measurements',
    attached: 'attachments',
    'stack-dumped': 'stacks',
    output: 'output',
};

export const LIST_NAMES: readonly ListName[] = Object.values(LIST_OF);

export function emptyLists(): Lists {
    return { messages: [], measurements: [], attachments: [], stacks: [], output: [] };
}

/** Adds an event of this source to its list. */
export function addToLists(lists: Lists, event: Event, run: string): void {
    const { seq, at } = event;
    switch (event.type) {
        case 'message':
            append(lists.messages, { seq, at, message: event.message });
            break;
        case 'measured': {
            const { measurement } = event;
            append(lists.measurements, { seq, at, measurement, within: isWithin(measurement) });
            break;
        }
        case 'attached': {
            const { attachment } = event;
            const url = address(['runs', run, 'files', ...attachment.path.split('/')]);
            append(lists.attachments, { seq, at, attachment, url });
            break;
        }
        case 'stack-dumped':
            append(lists.stacks, { seq, at, text: event.text });
            break;
        case 'output': {
            const { stream, text, omitted_bytes } = event;
            append(lists.output, { seq, at, stream, text, ...present({ omitted_bytes }) });
            break;
        }
    }
}

/** Pages and events may overlap: a known entry is dropped. */
export function append<T extends Said>(list: T[], entry: T): void {
    const last = list.at(-1);
    if (last === undefined || last.seq < entry.seq) list.push(entry);
}

/** Whether a value is finite and within its limits. */
export function isWithin({ value, low, high }: Measurement): boolean {
    if (value == null) return false;
    return (low == null || value >= low) && (high == null || value <= high);
}
