// From the events of a run to changes of the Test Explorer.

import type { EventOf, RunEvent, Source } from './events';
import { describe } from './describe';
import { TestFold } from './test-fold';
import type { Problem, Target, Update } from './updates';

/** Follows one run. */
export class RunFold {
    private readonly suites = new Map<number, EventOf<'suite-planned'>>();
    private readonly fixtures = new Map<number, EventOf<'fixture-planned'>>();
    private readonly hooks = new Map<number, EventOf<'hook-planned'>>();
    private readonly tests = new Map<number, TestFold>();
    private noSkips = false;
    private isFinished = false;

    /** Whether the run reported its start: rtf accepted its input. */
    hasStarted = false;

    /** Applies an event, and returns what changes. */
    apply(event: RunEvent): Update[] {
        const text = describe(event, this);
        const updates: Update[] = text === undefined ? [] : [{ kind: 'output', text }];
        switch (event.type) {
            case 'run-started':
                this.hasStarted = true;
                this.noSkips = event.manifest?.no_skips === true;
                break;
            case 'suite-planned':
                this.suites.set(event.suite, event);
                break;
            case 'fixture-planned':
                this.fixtures.set(event.fixture, event);
                break;
            case 'hook-planned':
                this.hooks.set(event.hook, event);
                break;
            case 'test-planned':
                this.plan(event);
                break;
            case 'fixture-collapsed':
                if (this.tolerates(event.fixture)) break;
                return [...updates, this.problem(this.fixtures.get(event.fixture), event.reason)];
            case 'fixture-broken':
                return [...updates, this.problem(this.fixtures.get(event.fixture), event.reason)];
            case 'fixture-stopped':
                if (event.problem == null) break;
                return [...updates, this.problem(this.fixtures.get(event.fixture), event.problem)];
            case 'hook-finished':
                if (event.problem == null) break;
                return [...updates, this.problem(this.hooks.get(event.hook), event.problem)];
            case 'run-finished':
            case 'runner-died':
                this.isFinished = true;
                return [...updates, ...this.openTests('the run ended during the test')];
            default:
                return [...updates, ...this.applyToTest(event)];
        }
        return updates;
    }

    /** Ends a stream that may be incomplete. */
    end(reason: string): Update[] {
        return this.isFinished ? [] : this.openTests(reason);
    }

    nameOf(source: Source): string {
        if (source.fixture !== undefined) {
            return `fixture ${this.fixtures.get(source.fixture)?.name ?? source.fixture}`;
        }
        if (source.hook !== undefined) {
            return `hook ${this.hooks.get(source.hook)?.name ?? source.hook}`;
        }
        return this.tests.get(source.test ?? -1)?.name ?? `test ${source.test}`;
    }

    suiteName(suite: number): string {
        return this.suites.get(suite)?.name ?? `suite ${suite}`;
    }

    private plan(event: EventOf<'test-planned'>): void {
        const suite = this.suites.get(event.suite);
        const skipsFail = this.noSkips || suite?.skips_fail === true;
        const names = { file: suite?.file ?? '', suite: this.suiteName(event.suite) };
        this.tests.set(event.test, new TestFold(event, names, skipsFail));
    }

    private applyToTest(event: RunEvent): Update[] {
        const id = testOf(event);
        return id === undefined ? [] : (this.tests.get(id)?.apply(event) ?? []);
    }

    private tolerates(fixture: number): boolean {
        const planned = this.fixtures.get(fixture);
        const suite = planned === undefined ? undefined : this.suites.get(planned.suite);
        return suite?.tolerates_collapse === true;
    }

    /** A problem of a fixture or a hook, which makes its suite red. */
    private problem(planned: { suite: number; name: string } | undefined, text: string): Update {
        const suite = planned === undefined ? undefined : this.suites.get(planned.suite);
        const target: Target = { file: suite?.file ?? '' };
        const problems: Problem[] = [{ text: `${planned?.name ?? 'fixture'}: ${text}` }];
        return { kind: 'finished', target, outcome: 'errored', problems, durationMs: undefined };
    }

    private openTests(reason: string): Update[] {
        return [...this.tests.values()].flatMap((test) => test.interrupt(reason));
    }
}

/** The test to which an event belongs. */
function testOf(event: RunEvent): number | undefined {
    if ('test' in event && event.test != null) return event.test;
    return 'source' in event ? event.source.test : undefined;
}
