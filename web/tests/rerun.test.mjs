// With the token, a user reruns the failed tests of a past run, and follows the new run.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Guarded, launch } from './support/browser.mjs';
import { Bench, step, within } from './support/rtf.mjs';
import { BROKEN } from './support/suites.mjs';

const RERUN = 'Rerun failed tests';

let browser;
let bench;

before(async () => {
    browser = await launch();
    bench = await Bench.make();
});
after(async () => {
    await browser.close();
    await bench.close();
});

/** Presses the button, confirms, and waits for the new run. */
async function rerun(guarded) {
    const { page } = guarded;
    const before = page.url();
    await guarded.button(RERUN).click();
    await guarded.see('Rerun 1 test?', 'dialog');
    await guarded.button('Yes, rerun failed tests').click();
    await page.waitForFunction((from) => location.href !== from, before);
}

test('failed tests are rerun from the page', async () => {
    await bench.runToEnd(BROKEN);
    const [past] = await bench.names();
    const serve = await bench.serve();
    const guarded = await Guarded.open(browser, serve.url);
    const { page } = guarded;

    await step('without the token there is no button', async () => {
        const reader = await Guarded.open(browser, `${serve.origin}/#/runs/${past}`);
        await reader.rowIs('Breaks', 'failed');
        await reader.button('Control …').waitFor();
        assert.equal(await reader.button(RERUN).count(), 0);
        await reader.close();
    });

    await step('the page goes to the new run, which can be stopped', async () => {
        await guarded.run(past).click();
        // Now it waits for a word that is never sent.
        await bench.write('suite.xml', BROKEN.replace('"fail">Ends', '"never">Step'));
        await rerun(guarded);
        await guarded.rowIs('Breaks', 'running');
        assert.equal(await guarded.row('Works').count(), 0);
        assert.equal(await guarded.button('Skip the rest').count(), 0);
        await guarded.button('Stop the run').click();
        await guarded.button('Yes, stop the run').click();
        await guarded.rowIs('Breaks', 'interrupted');
        // It was stopped, it did not fail.
        assert.equal(await guarded.button(RERUN).count(), 0);
    });

    await step('a test that was mended passes', async () => {
        await bench.write('suite.xml', BROKEN.replace('"fail">Ends', '"through">Step'));
        await page.evaluate((to) => (location.hash = to), `#/runs/${past}`);
        await guarded.rowIs('Breaks', 'failed');
        await guarded.see('failed', 'section.summary');
        await rerun(guarded);
        await guarded.rowIs('Breaks', 'passed');
        await guarded.see('green', 'section.summary');
        assert.equal(await guarded.button(RERUN).count(), 0);
    });

    await step('the server ends with nothing left', async () => {
        await guarded.close();
        serve.child.kill('SIGTERM');
        assert.equal(await within('the end of rtf serve', serve.ended), 143);
    });
});
