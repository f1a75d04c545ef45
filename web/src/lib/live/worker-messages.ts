// What a page and the worker that is shared by all pages say to each other.

import type { SseEvent, StreamEnd } from './sse';

export type ToWorker =
    | { kind: 'open'; id: number; run: string; from: number; details: readonly string[] }
    | { kind: 'close'; id: number };

export type FromWorker =
    | { kind: 'opened'; id: number }
    | { kind: 'received'; id: number; events: SseEvent[] }
    | { kind: 'ended'; id: number; end: StreamEnd };
