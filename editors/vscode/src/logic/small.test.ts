import { expect, test } from 'vitest';
import { Lines } from './lines';
import { locate } from './locate';
import { nodesToRun } from './selection';
import { StopRequests } from './stop';

test('lines are completed across pieces', () => {
    const lines = new Lines();
    expect([lines.push('a\nb'), lines.push(''), lines.push('c\n\nd')]).toEqual([
        ['a'],
        [],
        ['bc', ''],
    ]);
});

test('the first directory with the file wins; absolute names are taken as they are', () => {
    const exists = (path: string): boolean => path.startsWith('/b/') || path.startsWith('/c/');
    expect(locate('x.cpp', ['/a', '/b', '/c'], exists)).toBe('/b/x.cpp');
    expect(locate('/c/x.cpp', ['/a'], exists)).toBe('/c/x.cpp');
    expect(locate('x.cpp', ['/a'], exists)).toBeUndefined();
});

interface Node {
    id: string;
    parent: Node | undefined;
    children: Node[];
}

/** A tree from nested lists of names. */
function tree(id: string, children: [string, string[]][]): Map<string, Node> {
    const nodes = new Map<string, Node>();
    const add = (name: string, parent: Node | undefined, below: [string, string[]][]): Node => {
        const node = { id: name, parent, children: [] as Node[] };
        nodes.set(name, node);
        node.children = below.map(([child, rest]) =>
            add(
                child,
                node,
                rest.map((each) => [each, []]),
            ),
        );
        return node;
    };
    add(id, undefined, children);
    return nodes;
}

test('a selection has neither excluded items nor items twice', () => {
    const nodes = tree('arm', [
        ['Reach', ['left', 'right']],
        ['Grip', []],
    ]);
    const all = (...names: string[]): Node[] => names.map((name) => nodes.get(name) as Node);
    const run = (included: string[], excluded: string[]): string[] =>
        nodesToRun(all(...included), all(...excluded), ({ children }) => children).map(
            (node) => node.id,
        );
    expect(run(['arm'], [])).toEqual(['arm']);
    expect(run(['arm', 'Reach', 'left'], [])).toEqual(['arm']);
    expect(run(['arm'], ['Grip'])).toEqual(['Reach']);
    expect(run(['arm'], ['left'])).toEqual(['right', 'Grip']);
    expect(run(['Reach', 'Grip'], ['arm'])).toEqual([]);
    expect(run(['left', 'Grip'], ['left'])).toEqual(['Grip']);
});

test('a run is stopped in three steps, each with one signal', () => {
    const signals: string[] = [];
    const requests = new StopRequests();
    const actions = [1, 2, 3].map(() => requests.send((signal) => signals.push(signal))?.action);
    expect(actions).toEqual(['Skip Tear-Down', 'Kill Hooks, Too', undefined]);
    expect(signals).toEqual(['SIGINT', 'SIGINT', 'SIGINT']);
});
