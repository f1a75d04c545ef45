// The lines that the terminal of a test run shows for events that belong to no test.

import type { RunEvent } from './events';
import type { RunFold } from './fold';

/** Returns the text for an event; nothing for events that are shown at a test. */
export function describe(event: RunEvent, names: RunFold): string | undefined {
    switch (event.type) {
        case 'run-started':
            return `run ${event.run}\n`;
        case 'suite-waiting':
            return `suite ${names.suiteName(event.suite)} waits for ${event.lock}: ${event.held_by}\n`;
        case 'warning': {
            const { message, hint } = event.diagnostic;
            return `warning: ${message}\n${hint == null ? '' : `hint: ${hint}\n`}`;
        }
        case 'fixture-starting':
            return `${names.nameOf(event)} is starting\n`;
        case 'fixture-ready':
            return `${names.nameOf(event)} is ready\n`;
        case 'fixture-collapsed':
            return `${names.nameOf(event)} collapsed: ${event.reason}\n`;
        case 'fixture-broken':
            return `${names.nameOf(event)} is broken: ${event.reason}\n`;
        case 'fixture-stopped':
            return `${names.nameOf(event)} has stopped${because(event.problem)}\n`;
        case 'hook-started':
            return `${names.nameOf(event)} is running: ${event.reason}\n`;
        case 'hook-finished':
            return `${names.nameOf(event)} has finished${because(event.problem)}\n`;
        case 'runner-died':
            return `the runner died: ${event.reason}\n`;
        case 'run-finished':
            return event.interrupted == null ? undefined : `interrupted: ${event.interrupted}\n`;
        case 'output':
        case 'stack-dumped':
            return event.source.test === undefined ? event.text : undefined;
        case 'message': {
            const { source, test, message } = event;
            if (source.test !== undefined || test != null) return undefined;
            return `${names.nameOf(source)}: ${message.text}\n`;
        }
        default:
            return undefined;
    }
}

function because(problem: string | null | undefined): string {
    return problem == null ? '' : `: ${problem}`;
}
