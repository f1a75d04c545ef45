// Applies events to a test. The rules for its verdict are those
// of rtf_model::TestRecord.

import type { AttemptRow, Suite, Test } from '../api-types';
import type { Event, TestPlanned, TestState, Verdict } from '../event';
import { present } from '../present';
import { askedIn } from '../questions';
import { isGreenVerdict, significanceOf } from '../known-failure';

export function plannedTest(plan: TestPlanned): Test {
    const { timed, tags, parameters, expected } = plan;
    return {
        id: plan.test,
        suite: plan.suite,
        name: plan.name,
        plugin_type: plan.plugin_type,
        plugin: plan.plugin,
        repetitions: plan.repetitions,
        ...present({ timed: timed || null, tags, parameters }),
        ...present({ expected: expected as Test['expected'] }),
        state: 'pending',
        duration_us: 0,
        attempts: [],
        counts: {
            messages: 0,
            failures: 0,
            measurements: 0,
            violations: 0,
            attachments: 0,
            output_bytes: 0,
        },
    };
}

/** Applies an event of this test. */
export function applyToTest(test: Test, event: Event, suite?: Suite): void {
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
        case 'question-asked':
            // New lists: components keep the previous ones.
            test.questions = [...(test.questions ?? []), askedIn(event)];
            break;
        case 'question-closed':
            test.questions = (test.questions ?? []).filter(
                ({ question }) => question.question !== event.question,
            );
            if (test.questions.length === 0) delete test.questions;
            break;
        case 'fault-injected': {
            const { name, kind, effect, at } = event;
            if (last !== undefined)
                last.faults = [...(last.faults ?? []), { name, kind, effect, injected: at }];
            break;
        }
        case 'fault-removed': {
            const lasts = last?.faults?.findLast(
                (fault) => fault.name === event.name && fault.removed === undefined,
            );
            if (lasts !== undefined) lasts.removed = event.at;
            break;
        }
        case 'test-slow':
            test.slow = true;
            break;
        case 'test-stopping':
            if (last !== undefined) last.stopped = true;
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
                conclude(test, null, suite);
            break;
        case 'test-repeated':
            // The time has elapsed: the number of repetitions is known now.
            test.repetitions = event.repetitions;
            delete test.timed;
            conclude(test, null, suite);
            break;
        case 'test-skipped':
            conclude(test, event.reason, suite);
            break;
    }
}

/** Sets the final verdict: that of the first deciding attempt with a problem, else of the
 *  first that skipped itself. */
function conclude(test: Test, skipped: string | null, suite: Suite | undefined): void {
    const decisive = decisiveAttempt(test);
    const verdict = decisive?.verdict ?? 'passed';
    const bad = isBad(verdict) ? decisive : undefined;
    // The runner skips a test, or an attempt during which a fixture collapsed.
    const skippedItself = skipped === null && decisive?.stopped !== true;
    test.state = 'done';
    test.verdict = bad?.verdict ?? (skipped === null ? verdict : 'skipped');
    const reason = bad?.reason ?? skipped ?? decisive?.reason ?? null;
    if (reason !== null && test.verdict !== 'passed') test.reason = reason;
    const significance = significanceOf(test, test.verdict, skippedItself);
    if (significance !== null) test.significance = significance;
    test.green = isGreenVerdict(test.verdict, significance, suite);
}

/** Whether a verdict is a problem of the test; a test may skip itself. */
function isBad(verdict: Verdict | undefined): boolean {
    return verdict !== undefined && verdict !== 'passed' && verdict !== 'skipped';
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
    const deciding = decidingAttempts(test);
    return (
        deciding.find(({ verdict }) => isBad(verdict)) ??
        deciding.find(({ verdict }) => verdict === 'skipped') ??
        test.attempts.at(-1)
    );
}
