// Signals that belong to another one: the sides of the tube around a stored trajectory.

import type { Signal } from './api-types';
import type { SignalInterval } from './event';

/** When a monitor was violated, and its message. */
export interface Violation extends SignalInterval {
    text: string;
}

const SIDE = /^trajectory\/(.*?)(#\d+)?\/(low|high)$/s;

/** The name of the signal around which a signal is a side of the tube. */
function middleOf(name: string): string | undefined {
    return SIDE.exec(name)?.[1];
}

/** The sides of the tubes around a signal: `trajectory/elbow/low`, `trajectory/elbow#2/high`. */
export function tubeOf({ name, unit }: Signal, signals: readonly Signal[]): Signal[] {
    return signals.filter((each) => middleOf(each.name) === name && each.unit === unit);
}

/** The signals of violated monitors. */
export function violatedSignals(
    signals: readonly Signal[],
    violations: readonly Violation[],
): Signal[] {
    const names = new Set(violations.flatMap((violation) => violation.signals));
    return withoutTubes(signals).filter(({ name }) => names.has(name));
}

/** The signals that are no side of the tube around another one. */
export function withoutTubes(signals: readonly Signal[]): Signal[] {
    const sides = new Set(signals.flatMap((signal) => tubeOf(signal, signals)));
    return signals.filter((signal) => !sides.has(signal));
}
