// The durations of the tests in the last run of the same command.

import * as api from '../api';
import type { RunInfo } from '../api-types';
import { historyOf, type History } from '../progress';
import { RunRecord } from '../record/record';

/** Searches the runs before this one; empty if none has the same command. */
export async function loadHistory(info: RunInfo): Promise<History> {
    try {
        const { runs } = await api.runs(info.run, 20);
        const command = JSON.stringify(info.command);
        const last = runs.find(
            (run) => run.state === 'finished' && JSON.stringify(run.command) === command,
        );
        return last === undefined
            ? new Map()
            : historyOf(new RunRecord(await api.snapshot(last.run)));
    } catch {
        // Only an estimate depends on it, which can also use this run's tests.
        return new Map();
    }
}
