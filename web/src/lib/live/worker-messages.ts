// The messages between a page and the shared worker.

import type { Request } from './hub';
import type { SseEvent, StreamEnd } from './sse';

export type ToWorker = ({ kind: 'open'; id: number } & Request) | { kind: 'close'; id: number };

export type FromWorker =
    | { kind: 'opened'; id: number }
    | { kind: 'received'; id: number; events: SseEvent[] }
    | { kind: 'ended'; id: number; end: StreamEnd };
