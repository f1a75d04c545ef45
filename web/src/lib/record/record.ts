// The state of a run in the page: a snapshot and the events after it.
// Only this class applies events; every component reads
// the state from here. An empty record with all events
// of a journal equals a snapshot.

import type {
    Fixture,
    Hook,
    RunInfo,
    RunStateName,
    Snapshot,
    Suite,
    Test,
    Totals,
} from '../api-types';
import { VERDICTS, type Event, type SuitePrepared, type Verdict } from '../event';
import { present } from '../present';
import { applyToFixture, fixtureProblems, plannedFixture } from './fixture';
import { applyToHook, hookProblems, plannedHook } from './hook';
import { applyToTest, plannedTest, testState } from './test';

export class RunRecord {
    readonly info: RunInfo;
    readonly suites: readonly Suite[];
    readonly fixtures: readonly Fixture[];
    readonly hooks: readonly Hook[];
    readonly tests: readonly Test[];
    /** The run's `--no-skips`; a snapshot has it in its suites. */
    private noSkips = false;

    /** The parts of the data are never replaced. */
    constructor(private readonly data: Snapshot = emptySnapshot()) {
        this.info = data.info;
        this.suites = data.suites;
        this.fixtures = data.fixtures;
        this.hooks = data.hooks;
        this.tests = data.tests;
    }

    get warnings() {
        return this.data.warnings;
    }
    get leaked() {
        return this.data.leaked;
    }

    /** Whether the run has ended. */
    get isOver(): boolean {
        return this.info.state !== 'running';
    }

    /** The same record as a new object, so that components notice a change. */
    view(): RunRecord {
        return new RunRecord(this.data);
    }

    /** Applies the next event; a known event is dropped. */
    apply(event: Event): void {
        const { info } = this.data;
        if (event.seq < info.seq) return;
        info.seq = event.seq + 1;
        info.last_at = Math.max(info.last_at, event.at);
        const isOfTest = event.type !== 'hook-started' && event.type !== 'test-planned';
        if (isOfTest && 'test' in event && event.test != null) {
            const test = this.data.tests[event.test];
            if (test !== undefined) applyToTest(test, event, this.data.suites[test.suite]);
        } else if (
            'fixture' in event &&
            event.type !== 'fixture-planned' &&
            event.fixture != null
        ) {
            const fixture = this.data.fixtures[event.fixture];
            if (fixture !== undefined) applyToFixture(fixture, event);
        } else if ('hook' in event && event.type !== 'hook-planned') {
            const hook = this.data.hooks[event.hook];
            if (hook !== undefined) applyToHook(hook, event);
        } else {
            this.applyToRun(event);
        }
    }

    /** Records the progress of the run, when a stream has left out events. */
    progress(seq: number, at: number): void {
        this.info.seq = Math.max(this.info.seq, seq + 1);
        this.info.last_at = Math.max(this.info.last_at, at);
    }

    /** Records the end of the stream, and how the run ended. */
    finish(state: RunStateName): void {
        if (!this.isOver) this.info.state = state;
    }

    private applyToRun(event: Event): void {
        const { data } = this;
        const suite = 'suite' in event ? data.suites[event.suite] : undefined;
        switch (event.type) {
            case 'run-started':
                this.noSkips = event.manifest?.no_skips === true;
                Object.assign(data.info, {
                    run: event.run,
                    started_at: event.started_at,
                    rtf: event.rtf,
                    command: event.command,
                    working_dir: event.working_dir,
                    suites: event.suites,
                });
                break;
            case 'suite-planned':
                data.suites[event.suite] = plannedSuite(event, this.noSkips);
                break;
            case 'fixture-planned':
                data.fixtures[event.fixture] = plannedFixture(event);
                suite?.fixtures.push(event.fixture);
                break;
            case 'hook-planned':
                data.hooks[event.hook] = plannedHook(event);
                suite?.hooks.push(event.hook);
                break;
            case 'test-planned':
                data.tests[event.test] = plannedTest(event);
                break;
            case 'warning':
                data.warnings.push(event.diagnostic);
                break;
            case 'suite-started':
                Object.assign(suite ?? {}, { state: 'running', started: event.at });
                break;
            case 'suite-prepared':
                if (suite !== undefined) suite.prepared ??= preparedOf(event);
                break;
            case 'suite-finished':
                Object.assign(suite ?? {}, { state: 'finished', finished: event.at });
                break;
            case 'run-finished':
                data.info.state = event.interrupted == null ? 'finished' : 'interrupted';
                if (event.interrupted != null) data.info.interrupted = event.interrupted;
                data.info.green = this.isGreen();
                break;
            case 'runner-died':
                data.info.state = 'died';
                data.info.died = event.reason;
                data.info.green = false;
                data.leaked.push(...(event.leaked ?? []));
                break;
        }
    }

    /** The current state of a test. */
    stateOf(test: Test) {
        return testState(test, this.isOver);
    }

    /** Number of tests by state, of one suite or of all. */
    totals(suite?: number): Totals {
        const totals = noTotals();
        for (const test of this.tests) {
            if (suite !== undefined && test.suite !== suite) continue;
            const state = this.stateOf(test);
            totals.planned += 1;
            if (state === 'running' || state === 'pending') totals[state] += 1;
            else {
                totals.verdicts[state] += 1;
                totals.done += 1;
            }
        }
        return totals;
    }

    fixturesOf(suite: Suite): Fixture[] {
        return suite.fixtures.flatMap((id) => this.fixtures[id] ?? []);
    }

    hooksOf(suite: Suite): Hook[] {
        return suite.hooks.flatMap((id) => this.hooks[id] ?? []);
    }

    /** The problems of a suite apart from its tests. */
    suiteProblems(suite: Suite): string[] {
        const tolerates = suite.tolerates_collapse === true;
        return [
            ...this.fixturesOf(suite).flatMap((each) => fixtureProblems(each, tolerates)),
            ...this.hooksOf(suite).flatMap((each) => hookProblems(each, this.isOver)),
        ];
    }

    private isGreen(): boolean {
        return (
            this.info.damages.length === 0 &&
            this.info.state === 'finished' &&
            this.tests.length > 0 &&
            this.tests.every((test) => test.green === true) &&
            this.suites.every((suite) => this.suiteProblems(suite).length === 0)
        );
    }
}

function plannedSuite(plan: Extract<Event, { type: 'suite-planned' }>, noSkips: boolean): Suite {
    return {
        id: plan.suite,
        name: plan.name,
        file: plan.file ?? '',
        description: plan.description ?? '',
        environment: plan.environment ?? '',
        ...present({
            tolerates_collapse: plan.tolerates_collapse || null,
            skips_fail: plan.skips_fail || noSkips || null,
        }),
        state: 'pending',
        totals: noTotals(),
        problems: [],
        fixtures: [],
        hooks: [],
    };
}

/** The private resources of a suite, without the fields of the event. */
function preparedOf(event: Extract<Event, { type: 'suite-prepared' }>): SuitePrepared {
    const { suite, network, ports, variables, join_command } = event;
    return {
        suite,
        join_command,
        ...present({ network, ports, variables }),
    };
}

export function noTotals(): Totals {
    const verdicts = Object.fromEntries(VERDICTS.map((each) => [each, 0])) as Record<
        Verdict,
        number
    >;
    return { planned: 0, pending: 0, running: 0, done: 0, verdicts };
}

export function emptySnapshot(): Snapshot {
    const info: RunInfo = {
        run: '',
        started_at: '',
        rtf: '',
        command: [],
        working_dir: '',
        state: 'running',
        seq: 0,
        last_at: 0,
        suites: 0,
        suite_names: [],
        robots: [],
        bytes: 0,
        totals: noTotals(),
        problems: [],
        damages: [],
    };
    return { info, suites: [], fixtures: [], hooks: [], tests: [], warnings: [], leaked: [] };
}
