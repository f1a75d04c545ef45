// From items of the Test Explorer to what rtf runs.

/** The part of a test item that matters here. */
export interface Node {
    parent: Node | undefined;
}

/** Returns the nodes to run: each included one, without the excluded nodes and without those
 *  that another included node contains. */
export function nodesToRun<T extends Node>(
    included: readonly T[],
    excluded: readonly T[],
    childrenOf: (node: T) => readonly T[],
): T[] {
    const isIncluded = new Set<Node>(included);
    const isExcluded = new Set<Node>(excluded);
    const contains = (node: T): boolean =>
        childrenOf(node).some((child) => isExcluded.has(child) || contains(child));
    const without = (node: T): T[] => {
        if (isExcluded.has(node)) return [];
        return contains(node) ? childrenOf(node).flatMap(without) : [node];
    };
    return [...new Set(included)]
        .filter((node) => !ancestors(node).some((each) => isIncluded.has(each)))
        .filter((node) => !ancestors(node).some((each) => isExcluded.has(each)))
        .flatMap(without);
}

function ancestors({ parent }: Node): Node[] {
    return parent === undefined ? [] : [parent, ...ancestors(parent)];
}
