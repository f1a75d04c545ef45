// Finds the source file of a location: plug-ins name it as their compiler or interpreter does.

import { isAbsolute, join } from 'node:path';

/** Returns the path of an existing file, searching the directories in order. */
export function locate(
    file: string,
    dirs: readonly string[],
    exists: (path: string) => boolean,
): string | undefined {
    const paths = isAbsolute(file) ? [file] : dirs.map((dir) => join(dir, file));
    return paths.find(exists);
}
