// Stopping a run: which signal each request sends (docs/event-sequence.md).

/** How long the signals of one request belong together: rtf counts later ones as the next. */
export const REQUEST_MS = 500;

/** A further request that the user can make while the run is being stopped. */
export interface NextRequest {
    message: string;
    action: string;
}

const NEXT: readonly NextRequest[] = [
    {
        message:
            'rtf is stopping the run: hooks bring the robot into a safe state, and fixtures are torn down.',
        action: 'Skip Tear-Down',
    },
    {
        message: 'rtf has killed tests and fixtures. Hooks bring the robot into a safe state.',
        action: 'Kill Hooks, Too',
    },
];

/** Counts the requests to stop a run. Each of them sends one SIGINT. */
export class StopRequests {
    private requests = 0;

    /** Sends a request, and returns the next one that is possible. */
    send(kill: (signal: 'SIGINT') => void): NextRequest | undefined {
        kill('SIGINT');
        const next = NEXT[this.requests];
        this.requests += 1;
        return next;
    }
}
