// With the token, a user can stop the run, a test or a suite; without it there are no buttons.

import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { Guarded, launch } from './support/browser.mjs';
import { Bench, within } from './support/rtf.mjs';
import { WAITING } from './support/suites.mjs';

let browser;
let bench;
let run;

before(async () => {
    browser = await launch();
});
after(() => browser.close());
beforeEach(async () => {
    bench = await Bench.make();
    run = await bench.run(WAITING);
});
afterEach(() => bench.close());

const CONTROLS = ['Stop the run', 'Stop the test', 'Skip the rest'];

async function controls({ page }) {
    const counts = CONTROLS.map((name) => page.getByRole('button', { name, exact: true }).count());
    const found = await Promise.all(counts);
    return CONTROLS.filter((_, index) => found[index] > 0);
}

test('with the token a test is stopped, then the suite is skipped', async () => {
    const guarded = await Guarded.open(browser, run.url);
    await guarded.row('First').click();
    await guarded.button('Stop the test').click();
    await guarded.see('Stop First?', 'dialog');
    await guarded.button('Yes, stop the test').click();
    await guarded.rowIs('First', 'interrupted');
    await guarded.rowIs('Second', 'running');
    await guarded.page.getByRole('link', { name: '← Overview' }).click();
    await guarded.button('Skip the rest').click();
    await guarded.button('Yes, skip the rest').click();
    await guarded.rowIs('Second', 'interrupted');
    await guarded.rowIs('Third', 'skipped');
    await within('the end of the run', run.ended);
    await guarded.close();
});

test('with the token the run is stopped', async () => {
    const guarded = await Guarded.open(browser, run.url);
    await guarded.button('Stop the run').click();
    // Cancelling stops nothing.
    await guarded.button('No').click();
    await guarded.rowIs('First', 'running');
    await guarded.button('Stop the run').click();
    await guarded.button('Yes, stop the run').click();
    await guarded.see('interrupted', 'section.summary');
    await guarded.rowIs('First', 'interrupted');
    await guarded.rowIs('Third', 'skipped');
    await within('the end of the run', run.ended);
    // Loaded details stay although the server has exited.
    await guarded.see('Interrupted by');
    await guarded.close();
});

test('a lost token is reported by the first refused action', async () => {
    const guarded = await Guarded.open(browser, run.url);
    await guarded.button('Control is on').waitFor();
    await guarded.context.clearCookies();
    await guarded.button('Stop the run').click();
    await guarded.button('Yes, stop the run').click();
    await guarded.see(/token/, '[role=alert]');
    await guarded.button('Control …').waitFor();
    assert.equal(await guarded.button('Control is on').count(), 0);
    await guarded.rowIs('First', 'running');
    await guarded.close();
});

test('without the token there is no button, with it there is', async () => {
    const guarded = await Guarded.open(browser, run.origin);
    await guarded.rowIs('First', 'running');
    await guarded.row('First').click();
    await guarded.see('the arm is ready for never');
    assert.deepEqual(await controls(guarded), []);
    await guarded.button('Control …').click();
    const field = guarded.page.getByLabel('Token');
    await field.fill('not the token');
    await guarded.button('Enter').click();
    await guarded.see(/token/, '[role=alert]');
    assert.deepEqual(await controls(guarded), []);
    // Pasting the whole address from a terminal works, too.
    await field.fill(run.url);
    await field.press('Enter');
    await guarded.button('Stop the test').waitFor();
    assert.deepEqual(await controls(guarded), ['Stop the run', 'Stop the test']);
    // The token is a cookie that no script can read, and that survives a reload.
    assert.equal(await guarded.page.evaluate(() => document.cookie), '');
    await guarded.page.reload();
    await guarded.button('Stop the test').waitFor();
    // A click on the badge asks for confirmation.
    await guarded.button('Control is on').click();
    await guarded.button('Keep it').click();
    await guarded.button('Stop the test').waitFor();
    await guarded.button('Control is on').click();
    await guarded.button('Forget the token').click();
    await guarded.button('Stop the test').waitFor({ state: 'detached' });
    await guarded.button('Control …').waitFor();
    await guarded.close();
});
