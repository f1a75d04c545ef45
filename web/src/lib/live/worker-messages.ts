// The messages between a page and the shared worker.

import type { SseEvent, StreamEnd } from './sse';

export type ToWorker =
    | { kind: 'open'; id: number; run: string; from: number; details: readonly string[] }
    | { kind: 'close'; id: number };

export type FromWorker =
    | { kind: 'opened'; id: number }
    | { kind: 'received'; id: number; events: SseEvent[] }
    | { kind: 'ended'; id: number; end: StreamEnd };
