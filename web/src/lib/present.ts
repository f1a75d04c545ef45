/** The fields that have a value: an event may contain null where the API omits a field. */
export function present<T extends object>(fields: T): { [K in keyof T]?: NonNullable<T[K]> } {
    const pairs = Object.entries(fields).filter(([, value]) => value != null);
    return Object.fromEntries(pairs) as { [K in keyof T]?: NonNullable<T[K]> };
}
