// The stored event streams of the project, which every reader must support.

import { readdirSync, readFileSync } from 'node:fs';
import type { Event } from '../lib/event';
import { RunRecord } from '../lib/record/record';

const FOLDER = new URL('../../../crates/rtf-report/tests/streams/', import.meta.url);

export function names(): string[] {
    return readdirSync(FOLDER).map((name) => name.replace('.jsonl', ''));
}

/** All events of a stream; an incomplete last line is ignored. */
export function stream(name: string): Event[] {
    const text = readFileSync(new URL(`${name}.jsonl`, FOLDER), 'utf8');
    return text
        .slice(0, text.lastIndexOf('\n') + 1)
        .split('\n')
        .filter((line) => line !== '')
        .map((line) => JSON.parse(line) as Event);
}

export function recordOf(events: Event[]): RunRecord {
    const record = new RunRecord();
    for (const event of events) record.apply(event);
    return record;
}
