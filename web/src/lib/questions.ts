// Questions of tests to an operator, as text.

import type { Asked } from './api-types';
import type { Event } from './event';
import { present } from './present';

const PLACES = { console: 'on the console', page: 'on the page', api: 'over the API' } as const;

/** The answer and who gave it, or why there is none; as `QuestionClosed::summary`. */
export function answerText({ closed }: Asked): string {
    if (closed === undefined) return 'waits for an answer';
    const { answer, by, reason } = closed;
    const place = by && (by.who == null ? PLACES[by.via] : `${by.who}, ${PLACES[by.via]}`);
    if (answer !== undefined)
        return place === undefined ? `${answer} (default: ${reason})` : `${answer} (${place})`;
    return place === undefined ? `not answered: ${reason}` : `declined (${place})`;
}

/** The question of an event, which waits for an answer. */
export function askedIn(event: Extract<Event, { type: 'question-asked' }>): Asked {
    const { at, question, text, choices, default: usual, timeout_ms, picture } = event;
    const maybe = present({ choices, default: usual, picture });
    return { at, question: { question, text, timeout_ms, ...maybe } };
}
