/** A copy of a set with the item added, or removed if the set has it. */
export function toggled<T>(set: ReadonlySet<T>, item: T): Set<T> {
    const next = new Set(set);
    if (!next.delete(item)) next.add(item);
    return next;
}
