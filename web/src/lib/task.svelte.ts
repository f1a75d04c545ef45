// Work that can fail, for example a request.

/** The text of what was thrown. */
export function messageOf(problem: unknown): string {
    return problem instanceof Error ? problem.message : String(problem);
}

export class Task {
    /** Why it failed the last time. */
    problem: string | null = $state(null);

    /** Whether the work succeeded. Aborted work has no problem. */
    async run(work: () => Promise<unknown>, signal?: AbortSignal): Promise<boolean> {
        try {
            await work();
            this.problem = null;
            return true;
        } catch (problem) {
            if (!signal?.aborted) this.problem = messageOf(problem);
            return false;
        }
    }
}
