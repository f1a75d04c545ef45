// Applies events to a test. The rules for its verdict are those
// of rtf_model::TestRecord.

import type { AttemptRow, Test } from '../api-types';
import type { Event, TestPlanned, TestState, Verdict } from '../event';

const NO_COUNTS = {
    messages: 0,
    failures: 0,
    measurements: 0,
    violations: 0,
    attachments: 0,
    output_bytes: 0,
};

export function plannedTest(plan: TestPlanned): Test {
    const { test, suite, name, plugin_type, plugin, repetitions, timed, tags } = plan;
    return {
        id: test,
        suite,
        name,
        plugin_type,
        plugin,
        repetitions,
        ...(timed === true ? { timed } : {}),
        ...(tags === undefined ? {} : { tags }),
        state: 'pending',
        duration_us: 0,
        attempts: [],
        counts: { ...NO_COUNTS },
    };
}

/** Applies an event of this test. */
export function applyToTest(test: Test, event: Event): void {
    const last = test.attempts.at(-1);
    switch (event.type) {
        case 'test-started': {
            const { repetition, attempt, at } = event;
            const number = test.attempts.length + 1;
            test.attempts.push({ number, repetition, attempt, started: at });
            test.state = 'running';
            break;
        }
        case 'test-phase':
            test.phase = event.phase;
            // It is judged; the remaining time is spent on notifying fixtures.
            if (event.phase === 'notify' && last !== undefined)
                test.duration_us += event.at - last.started;
            break;
        case 'test-slow':
            test.slow = true;
            break;
        case 'test-finished':
            if (last === undefined) return;
            last.finished = event.at;
            last.verdict = event.verdict;
            if (event.rerun) last.rerun = true;
            if (event.reason != null) last.reason = event.reason;
            if (test.phase !== 'notify') test.duration_us += event.at - last.started;
            delete test.phase;
            test.state = 'pending';
            if (!event.rerun && test.timed !== true && last.repetition >= test.repetitions)
                conclude(test, null);
            break;
        case 'test-repeated':
            // The time has elapsed: the number of repetitions is known now.
            test.repetitions = event.repetitions;
            delete test.timed;
            conclude(test, null);
            break;
        case 'test-skipped':
            conclude(test, event.reason);
            break;
    }
}

/** Sets the final verdict: that of the first deciding attempt that did not pass, if there is one. */
function conclude(test: Test, skipped: string | null): void {
    const bad = decidingAttempts(test).find(({ verdict }) => isBad(verdict));
    test.state = 'done';
    test.verdict = bad?.verdict ?? (skipped === null ? 'passed' : 'skipped');
    const reason = bad?.reason ?? skipped;
    if (reason !== null && test.verdict !== 'passed') test.reason = reason;
}

function isBad(verdict: Verdict | undefined): boolean {
    return verdict !== undefined && verdict !== 'passed';
}

/** The deciding attempts: the last one of each repetition. */
export function decidingAttempts(test: Test): AttemptRow[] {
    return test.attempts.filter(
        (attempt, index) => test.attempts[index + 1]?.repetition !== attempt.repetition,
    );
}

/** The state of a test; `isOver`: its run has ended. */
export function testState(test: Test, isOver: boolean): TestState {
    if (test.verdict !== undefined) return test.verdict;
    if (isOver) return test.attempts.length === 0 ? 'skipped' : 'interrupted';
    return test.state === 'running' ? 'running' : 'pending';
}

/** Whether it passed only after a retry. */
export function isFlaky(test: Test): boolean {
    return test.verdict === 'passed' && test.attempts.some((attempt) => attempt.rerun === true);
}

/** The attempt to show first: the decisive one, or the last. */
export function decisiveAttempt(test: Test): AttemptRow | undefined {
    return decidingAttempts(test).find(({ verdict }) => isBad(verdict)) ?? test.attempts.at(-1);
}
