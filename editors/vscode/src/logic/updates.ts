// The changes of the Test Explorer that a run causes.

import type { Location } from './list';
import type { Outcome } from './verdict';

/** An item: a suite, one of its tests, or a case of that. */
export interface Target {
    /** The file of the suite, as rtf names it. */
    file: string;
    test?: string;
    /** The path of a case: the names from the outermost case on. */
    cases?: readonly string[];
}

/** A message to show at a line of a source file. */
export interface Problem {
    text: string;
    location?: Location;
    /** The values of a failed comparison. */
    expected?: string;
    actual?: string;
}

export type Update =
    | { kind: 'started'; target: Target; location?: Location }
    | {
          kind: 'finished';
          target: Target;
          outcome: Outcome;
          problems: Problem[];
          durationMs: number | undefined;
      }
    /** `target` is missing if the text belongs to no test. */
    | { kind: 'output'; target?: Target; text: string; location?: Location };
