// Pictures of tests that are compared with stored ones.

import type { AttachmentEntry } from './api-types';

/** The end of the path of a file that belongs to a picture. */
const PART = /-(?:reference|difference)\.(?:png|jpg)$/;

/** Attachments; a compared picture, its reference and the difference are one group. */
export function grouped(entries: readonly AttachmentEntry[]): AttachmentEntry[][] {
    const groups: AttachmentEntry[][] = [];
    const pictures = new Map<string, AttachmentEntry[]>();
    for (const entry of entries) {
        const { path, picture } = entry.attachment;
        const owner = pictures.get(path.replace(PART, ''));
        if (owner !== undefined && PART.test(path)) {
            owner.push(entry);
            continue;
        }
        const group = [entry];
        groups.push(group);
        if (picture != null) pictures.set(path.replace(/\.[^./]*$/, ''), group);
    }
    return groups;
}
