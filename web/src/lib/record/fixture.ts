// Applies events to a fixture; its life as spans and marks.

import type { Fixture, ProvidedValue } from '../api-types';
import type { Event, FixturePlanned, FixtureProvided } from '../event';

/** A stretch of a fixture's life; `to` is `null` while it lasts. */
export interface Span {
    state: 'starting' | 'ready' | 'collapsed' | 'stopping';
    from: number;
    to: number | null;
}

/** Something that happened to a fixture at one moment. */
export interface Mark {
    kind: 'collapsed' | 'restarted' | 'problem';
    at: number;
    text: string;
}

export function plannedFixture(plan: FixturePlanned): Fixture {
    const { fixture, suite, name, plugin_type } = plan;
    return { id: fixture, suite, name, plugin_type, state: 'pending', starts: [] };
}

/** Applies an event of this fixture. */
export function applyToFixture(fixture: Fixture, event: Event): void {
    const { at } = event;
    const last = fixture.starts.at(-1);
    switch (event.type) {
        case 'fixture-starting':
            fixture.starts.push({ number: event.attempt, starting: at });
            delete fixture.values;
            fixture.state = 'starting';
            break;
        case 'fixture-provided':
            // A new list: components keep the previous one.
            fixture.values = [...(fixture.values ?? []), provided(event)];
            break;
        case 'fixture-ready':
            if (last !== undefined) last.ready = at;
            fixture.state = 'ready';
            break;
        case 'fixture-collapsed':
            if (last !== undefined) last.collapsed = { at, reason: event.reason };
            fixture.log_tail = event.log_tail ?? [];
            fixture.state = 'collapsed';
            break;
        case 'fixture-stopping':
            if (last !== undefined) last.stopping = at;
            fixture.state = 'stopping';
            break;
        case 'fixture-stopped':
            if (last !== undefined) last.stopped = at;
            fixture.state = fixture.broken === undefined ? 'stopped' : 'broken';
            if (event.problem != null) {
                if (last !== undefined) last.problem = event.problem;
                fixture.log_tail = event.log_tail ?? [];
            }
            break;
        case 'fixture-broken':
            fixture.broken = event.reason;
            fixture.state = 'broken';
            break;
    }
}

function provided({ name, value, secret }: FixtureProvided): ProvidedValue {
    return secret === true ? { name, secret } : { name, value };
}

/** The text of a value: of a string the string, of any other value its compact JSON. */
export function valueText({ value }: ProvidedValue): string {
    if (value === undefined) return '***';
    return typeof value === 'string' ? value : JSON.stringify(value);
}

/** A fixture's life, for its lane. */
export function spans(fixture: Fixture): Span[] {
    return fixture.starts.flatMap((start) => {
        const { starting, ready, collapsed, stopping, stopped } = start;
        const steps: [Span['state'], number | undefined][] = [
            ['starting', starting],
            ['ready', ready],
            ['collapsed', collapsed?.at],
            ['stopping', stopping],
        ];
        const reached = steps.flatMap(([state, from]) =>
            from === undefined ? [] : [{ state, from }],
        );
        return reached.map((step, index) => ({
            ...step,
            to: reached[index + 1]?.from ?? stopped ?? null,
        }));
    });
}

/** The marks of a fixture's life. */
export function marks(fixture: Fixture): Mark[] {
    return fixture.starts.flatMap(({ number, collapsed, problem, ...life }, index) => {
        const found: Mark[] = [];
        const end = life.stopped ?? life.stopping ?? life.starting;
        if (index > 0)
            found.push({ kind: 'restarted', at: life.starting, text: `start ${number}` });
        if (collapsed) found.push({ kind: 'collapsed', at: collapsed.at, text: collapsed.reason });
        if (problem) found.push({ kind: 'problem', at: end, text: problem });
        return found;
    });
}

/** The reasons why the suite is not green. */
export function fixtureProblems(fixture: Fixture, toleratesCollapse: boolean): string[] {
    const name = `fixture \`${fixture.name}\``;
    const problems: string[] = [];
    if (fixture.broken !== undefined) problems.push(`${name} is broken: ${fixture.broken}`);
    for (const { collapsed, problem } of fixture.starts) {
        if (collapsed && !toleratesCollapse)
            problems.push(`${name} collapsed: ${collapsed.reason}`);
        if (problem !== undefined && problem !== fixture.broken)
            problems.push(`${name}: ${problem}`);
    }
    return problems;
}
