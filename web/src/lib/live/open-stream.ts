// A stream of a run's events, over a separate connection.

import { address } from '../api';
import type { Request, StreamOptions } from './hub';
import { follow, type StreamEnd } from './sse';

export function openStream(request: Request, options: StreamOptions): Promise<StreamEnd> {
    const { run, from } = request;
    const details = request.details.length === 0 ? 'none' : request.details.join(',');
    const url = address(['runs', run, 'events'], { from, details });
    return follow(url, from === 0 ? null : from - 1, options);
}
