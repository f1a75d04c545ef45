// The worker that all pages of this server share: it owns the event streams.

import { Hub } from './hub';
import { openStream } from './open-stream';
import type { FromWorker, ToWorker } from './worker-messages';

const hub = new Hub(openStream);

function connect(port: MessagePort): void {
    const open = new Map<number, () => void>();
    const send = (message: FromWorker) => port.postMessage(message);
    port.onmessage = ({ data }: MessageEvent<ToWorker>) => {
        const { id } = data;
        open.get(id)?.();
        open.delete(id);
        if (data.kind === 'close') return;
        const { run, from, details } = data;
        open.set(
            id,
            hub.subscribe(run, {
                from,
                details,
                opened: () => send({ kind: 'opened', id }),
                received: (events) => send({ kind: 'received', id, events }),
                ended: (end) => {
                    open.delete(id);
                    send({ kind: 'ended', id, end });
                },
            }),
        );
    };
}

addEventListener('connect', (event) => {
    for (const port of (event as MessageEvent).ports) connect(port);
});
