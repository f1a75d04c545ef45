/** The text of what was thrown. */
export function messageOf(problem: unknown): string {
    return problem instanceof Error ? problem.message : String(problem);
}
