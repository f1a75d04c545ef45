// Reads a stream of server-sent events. Unlike `EventSource`, it delivers
// all events of a network chunk at once, checks the server's heartbeat, and
// reports why a connection was refused.

export interface SseEvent {
    type: string;
    id: string;
    data: string;
}

/** Splits text that arrives in arbitrary chunks into events (HTML Standard, 9.2.6). */
export class SseParser {
    private rest = '';
    private type = '';
    private data: string[] = [];
    private id = '';

    push(text: string): SseEvent[] {
        const events: SseEvent[] = [];
        const lines = (this.rest + text).split('\n');
        this.rest = lines.pop() ?? '';
        for (const line of lines) this.line(line.endsWith('\r') ? line.slice(0, -1) : line, events);
        return events;
    }

    private line(line: string, events: SseEvent[]): void {
        if (line === '') {
            if (this.data.length > 0) {
                const type = this.type === '' ? 'message' : this.type;
                events.push({ type, id: this.id, data: this.data.join('\n') });
            }
            this.type = '';
            this.data = [];
            return;
        }
        // A comment has an empty name.
        const [, name, value = ''] = /^([^:]*):? ?(.*)$/s.exec(line) ?? [];
        if (name === 'data') this.data.push(value);
        else if (name === 'event') this.type = value;
        else if (name === 'id') this.id = value;
    }
}

/** How a stream ended, if it was not aborted. */
export type StreamEnd = { status: number } | { lost: true };

export interface StreamOptions {
    signal: AbortSignal;
    opened: () => void;
    received: (events: SseEvent[]) => void;
}

/** The server sends at least a comment each second. */
const SILENCE_MS = 8000;

/** Follows a stream until it ends or its connection is lost. `lastEventId` is `null` for the first
 *  connection. */
export async function follow(
    url: string,
    lastEventId: number | null,
    options: StreamOptions,
): Promise<StreamEnd> {
    const silence = new AbortController();
    let timer = setTimeout(() => silence.abort(), SILENCE_MS);
    try {
        const resume: Record<string, string> =
            lastEventId === null ? {} : { 'Last-Event-ID': String(lastEventId) };
        const response = await fetch(url, {
            headers: { Accept: 'text/event-stream', ...resume },
            cache: 'no-store',
            signal: AbortSignal.any([options.signal, silence.signal]),
        });
        if (response.status !== 200 || response.body === null) return { status: response.status };
        options.opened();
        const parser = new SseParser();
        const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
        for (;;) {
            const { done, value } = await reader.read();
            if (done) return { lost: true };
            clearTimeout(timer);
            timer = setTimeout(() => silence.abort(), SILENCE_MS);
            const events = parser.push(value);
            if (events.length > 0) options.received(events);
        }
    } catch {
        return { lost: true };
    } finally {
        clearTimeout(timer);
    }
}
