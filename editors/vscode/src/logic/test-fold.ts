// Follows one test of a run: its attempts, its cases, and the verdict that counts.

import type { EventOf, Measurement, Message, RunEvent, Verdict } from './events';
import type { Location } from './list';
import type { Problem, Target, Update } from './updates';
import { isBad, judge, type Outcome, outcomeOf } from './verdict';

interface Case {
    target: Target;
    startedAt: number;
    problems: Problem[];
}

/** The attempt that decides, and what it reported. */
interface Decision {
    verdict: Verdict;
    reason: string | undefined;
    problems: Problem[];
}

export class TestFold {
    readonly name: string;
    private readonly target: Target;
    private readonly cases = new Map<number, Case>();
    private repetitions: number;
    private timed: boolean;
    private repetition = 0;
    private startedAt: number | undefined;
    private isOpen = false;
    private durationUs = 0;
    private problems: Problem[] = [];
    private decision: Decision | undefined;

    constructor(
        private readonly plan: EventOf<'test-planned'>,
        names: { file: string; suite: string },
        private readonly skipsFail: boolean,
    ) {
        this.target = { file: names.file, test: plan.name };
        this.name = `${names.suite}/${plan.name}`;
        this.repetitions = plan.repetitions;
        this.timed = plan.timed === true;
    }

    /** Applies an event of this test. */
    apply(event: RunEvent): Update[] {
        switch (event.type) {
            case 'test-started':
                return this.start(event);
            case 'test-phase':
                if (event.phase === 'notify') this.stopClock(event.at);
                return [];
            case 'test-stopping':
                return [this.output(`stopping: ${event.reason}\n`)];
            case 'test-finished':
                return this.finish(event);
            case 'test-repeated':
                this.timed = false;
                this.repetitions = event.repetitions;
                return this.conclude();
            case 'test-skipped':
                return this.skip(event.reason);
            case 'case-started':
                return this.startCase(event);
            case 'case-finished':
                return this.finishCase(event);
            case 'message':
                return this.message(event.message);
            case 'measured':
                return this.measured(event.measurement);
            case 'output':
            case 'stack-dumped':
                return [this.output(event.text)];
            default:
                return [];
        }
    }

    /** Ends a test that runs when the stream ends. */
    interrupt(reason: string): Update[] {
        if (!this.isOpen) return [];
        return [this.finished('errored', [...this.problems, { text: reason }])];
    }

    private start({ at, repetition, attempt }: EventOf<'test-started'>): Update[] {
        const isFirst = this.repetition === 0;
        this.isOpen = true;
        this.startedAt = at;
        this.repetition = repetition;
        this.problems = [];
        this.cases.clear();
        const started: Update[] = isFirst ? [{ kind: 'started', target: this.target }] : [];
        const again = [
            repetition > 1 ? `repetition ${repetition}` : '',
            attempt > 1 ? `attempt ${attempt}` : '',
        ].filter((text) => text !== '');
        return again.length === 0 ? started : [...started, this.output(`${again.join(', ')}\n`)];
    }

    private finish({ at, verdict, reason, rerun }: EventOf<'test-finished'>): Update[] {
        this.stopClock(at);
        const problems = withReason(this.problems, isBad(verdict) ? reason : undefined);
        const line = this.output(`${verdict}${reason == null ? '' : `: ${reason}`}\n`);
        if (rerun === true) return [line];
        const isDecided = this.decision !== undefined && isBad(this.decision.verdict);
        if (!isDecided && (this.decision === undefined || verdict !== 'passed')) {
            this.decision = { verdict, reason: reason ?? undefined, problems };
        }
        if (this.timed || this.repetition < this.repetitions) return [line];
        return [line, ...this.conclude()];
    }

    private conclude(): Update[] {
        const { verdict = 'passed', reason, problems = [] } = this.decision ?? {};
        const { outcome, note } = judge(verdict, this.plan.expected, this.skipsFail);
        const notes = note === undefined ? [] : [this.output(`${note}\n`)];
        const isRed = outcome === 'failed' || outcome === 'errored';
        const shown = isRed ? withReason(problems, note ?? reason ?? verdict) : [];
        return [...notes, this.finished(outcome, shown)];
    }

    private skip(reason: string): Update[] {
        if (this.decision !== undefined && isBad(this.decision.verdict)) return this.conclude();
        const started: Update[] =
            this.repetition === 0 ? [{ kind: 'started', target: this.target }] : [];
        const text = this.output(`skipped: ${reason}\n`);
        return [...started, text, this.finished('skipped', [])];
    }

    private startCase(event: EventOf<'case-started'>): Update[] {
        const parent = event.parent == null ? undefined : this.cases.get(event.parent);
        const target = { ...this.target, cases: [...(parent?.target.cases ?? []), event.name] };
        this.cases.set(event.case, { target, startedAt: event.at, problems: [] });
        return [{ kind: 'started', target, ...located(event.location) }];
    }

    private finishCase(event: EventOf<'case-finished'>): Update[] {
        const { verdict, reason, at, duration_us: duration } = event;
        const found = this.cases.get(event.case);
        if (found === undefined) return [];
        const outcome = verdict === 'skipped' && this.skipsFail ? 'failed' : outcomeOf(verdict);
        const isRed = outcome === 'failed' || outcome === 'errored';
        return [
            {
                kind: 'finished',
                target: found.target,
                outcome,
                problems: isRed ? withReason(found.problems, reason ?? verdict) : [],
                durationMs: (duration ?? at - found.startedAt) / 1000,
            },
        ];
    }

    private message(message: Message): Update[] {
        const { kind, text, location } = message;
        const isProblem = kind === 'failure' || kind === 'error';
        if (isProblem) this.problemsOf(message.case).push(problemOf(message));
        const label = isProblem ? `${kind}: ` : '';
        return [this.output(`${label}${text}\n`, message.case, location)];
    }

    private measured(measurement: Measurement): Update[] {
        const { name, value, unit, low, high, location } = measurement;
        const isLow = low != null && (value === null || value < low);
        const isHigh = high != null && (value === null || value > high);
        const shown = value === null ? 'not a finite number' : `${value} ${unit}`.trimEnd();
        const limits = limitsOf(low, high);
        const text = `\`${name}\` is ${shown}${limits && `, its limits are ${limits}`}`;
        if (isLow || isHigh) {
            this.problemsOf(measurement.case).push({ text, ...located(location) });
        }
        return [this.output(`${text}\n`, measurement.case, location)];
    }

    /** The problems of a case, or of the test itself. */
    private problemsOf(id: number | null | undefined): Problem[] {
        return (id == null ? undefined : this.cases.get(id)?.problems) ?? this.problems;
    }

    private stopClock(at: number): void {
        if (this.startedAt === undefined) return;
        this.durationUs += at - this.startedAt;
        this.startedAt = undefined;
    }

    private output(text: string, id?: number | null, location?: Location | null): Update {
        const target = (id == null ? undefined : this.cases.get(id)?.target) ?? this.target;
        return { kind: 'output', target, text, ...located(location) };
    }

    private finished(outcome: Outcome, problems: Problem[]): Update {
        this.isOpen = false;
        const durationMs = this.durationUs / 1000;
        return { kind: 'finished', target: this.target, outcome, problems, durationMs };
    }
}

/** As rtf prints limits. */
function limitsOf(low: number | null | undefined, high: number | null | undefined): string {
    if (low == null) return high == null ? '' : `≤ ${high}`;
    return high == null ? `≥ ${low}` : `${low} … ${high}`;
}

function located(location: Location | null | undefined): { location?: Location } {
    return location == null ? {} : { location };
}

/** Adds the reason of a verdict, unless a message has it already. */
function withReason(problems: Problem[], reason: string | null | undefined): Problem[] {
    if (reason == null || problems.some(({ text }) => text.includes(reason))) return problems;
    return [...problems, { text: reason }];
}

function problemOf({ text, location, comparison }: Message): Problem {
    const values =
        comparison == null
            ? {}
            : { expected: numbers(comparison.expected), actual: numbers(comparison.got) };
    return { text, ...located(location), ...values };
}

function numbers(values: (number | null)[]): string {
    return values.map((value) => value ?? 'not finite').join('\n');
}
