// From items of the Test Explorer to what rtf runs.

/** The part of a test item that matters here. */
export interface Node {
    id: string;
    parent: Node | undefined;
    children: readonly Node[];
}

/** Returns the nodes to run: each included one, without the excluded nodes and without those
 *  that another included node contains. */
export function nodesToRun(included: readonly Node[], excluded: readonly Node[]): Node[] {
    const isIncluded = new Set(included);
    const isExcluded = new Set(excluded);
    return [...isIncluded]
        .filter((node) => !ancestors(node).some((each) => isIncluded.has(each)))
        .filter((node) => !ancestors(node).some((each) => isExcluded.has(each)))
        .flatMap((node) => without(node, isExcluded));
}

function without(node: Node, excluded: ReadonlySet<Node>): Node[] {
    if (excluded.has(node)) return [];
    if (!contains(node, excluded)) return [node];
    return node.children.flatMap((child) => without(child, excluded));
}

function contains(node: Node, wanted: ReadonlySet<Node>): boolean {
    return node.children.some((child) => wanted.has(child) || contains(child, wanted));
}

function ancestors(node: Node): Node[] {
    return node.parent === undefined ? [] : [node.parent, ...ancestors(node.parent)];
}
