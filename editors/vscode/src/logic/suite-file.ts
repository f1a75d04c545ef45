// Recognises suites among XML files.

const PROLOGUE = /^\uFEFF?(?:\s|<\?[\s\S]*?\?>|<!--[\s\S]*?-->|<!DOCTYPE[^>]*>)*/;

/** Whether the root element of a document is `<suite>`. */
export function isSuite(text: string): boolean {
    return /^<suite[\s/>]/.test(text.replace(PROLOGUE, ''));
}

/** A glob that matches exactly these files, for the XML extension. */
export function globOf(files: readonly string[]): string {
    const escaped = files.map((file) => file.replace(/[\\*?[\]{},]/g, '\\$&'));
    return `{${escaped.join(',')}}`;
}
