// Example 02, as its lesson describes it: the simulation of an arm dies during a
// test, is restarted, and is parked at the end.

import assert from 'node:assert/strict';
import { cp } from 'node:fs/promises';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { Guarded, launch } from './support/browser.mjs';
import { Bench, step, within } from './support/rtf.mjs';

const EXAMPLES = fileURLToPath(new URL('../../examples/', import.meta.url));
const EXAMPLE = 'examples/02-supervised-simulator/supervised.xml';
/** MuJoCo starts slowly on a busy machine. */
const EXAMPLE_MS = 60_000;

let browser;
let bench;

before(async () => {
    browser = await launch();
    // The first page is the slowest, and the arm does not wait for it.
    await (await browser.newPage()).close();
    bench = await Bench.make();
    await cp(EXAMPLES, path.join(bench.dir, 'examples'), { recursive: true });
});
after(async () => {
    await browser.close();
    await bench.close();
});

/** Number of events of a type so far, from the server. */
async function count(run, type) {
    const answer = await fetch(`${run.origin}/api/v1/runs/current/journal`);
    const lines = (await answer.text()).split('\n').filter((line) => line.endsWith('}'));
    return lines.filter((line) => JSON.parse(line).type === type).length;
}

test('an arm is watched from its start over its collapse to its end', async () => {
    const run = await bench.start(['run', '--web=127.0.0.1:0', EXAMPLE]);
    const guarded = await Guarded.open(browser, run.url);
    const { page } = guarded;
    page.setDefaultTimeout(EXAMPLE_MS);
    const rows = page.getByRole('treeitem', { level: 2 });

    await step('the arm starts, and the first test moves it', async () => {
        await guarded.see('0 of 2', 'section.summary');
        await guarded.see('ready', 'article');
        await rows.filter({ hasText: 'running:' }).waitFor();
    });

    await step('it dies, and is restarted', async () => {
        await guarded.button('Table').click();
        await guarded.see(/^collapsed: /, '.timeline');
        await guarded.see('restarted: start 2', '.timeline');
        await rows.first().click();
        await guarded.see('attempt 2');
    });

    await step('a reload in the middle loses nothing', async () => {
        assert.equal(await count(run, 'run-finished'), 0, 'it still continues');
        await page.reload();
        await page.getByRole('link', { name: 'collapsed attempt 1' }).click();
        await guarded.see(/fixture `arm` collapsed/, '#detail');
        await guarded.button('Table').click();
        await guarded.see(/^collapsed: /, '.timeline');
        await guarded.see('restarted: start 2', '.timeline');
        await guarded.see('live', '.connection');
    });

    await step('both tests pass in the end, and the arm is parked', async () => {
        await guarded.see('2 of 2', 'section.summary');
        await guarded.see('green', 'section.summary');
        await page.getByRole('link', { name: '← Overview' }).click();
        await guarded.see('run 2 times', 'article');
        assert.deepEqual(await rows.getByText('passed:').count(), 2);
        assert.equal(await within('the end of the run', run.ended), 0);
    });

    await guarded.close();
});
