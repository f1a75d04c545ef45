// How long the tests took the last time that the same command was run.

import * as api from '../api';
import type { RunInfo } from '../api-types';
import { historyOf, type History } from '../progress';
import { RunRecord } from '../record/record';

/** Looks among the runs before this one; empty when there is none like it. */
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
        // It is for an estimate only, which this run's own tests can give as well.
        return new Map();
    }
}
