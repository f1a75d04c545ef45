// Typical use of the page: find a run, read a test, follow it in many tabs, and what
// stays when the server exits.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Guarded, launch } from './support/browser.mjs';
import { Bench, step, within } from './support/rtf.mjs';
import { BROKEN, MIXED, SIGNALS, WAITING } from './support/suites.mjs';

/** A laptop's screen, without the browser's own bars. */
const LAPTOP = { viewport: { width: 1366, height: 657 } };

let browser;
let bench;
let serve;
let names;

before(async () => {
    browser = await launch();
    bench = await Bench.make();
    await bench.runToEnd(MIXED);
    await bench.runToEnd(BROKEN);
    await bench.runToEnd(SIGNALS);
    names = await bench.names();
    serve = await bench.serve();
});
after(async () => {
    await browser.close();
    await bench.close();
});

function open(hash, options = LAPTOP) {
    return Guarded.open(browser, `${serve.origin}/${hash}`, options);
}

test('nothing scrolls away into blank', async () => {
    const [mixed, , signals] = names;
    for (const options of [LAPTOP, { viewport: { width: 390, height: 780 } }]) {
        const guarded = await open('#/runs', options);
        for (const [hash, ready] of [
            ['#/runs', mixed],
            [`#/runs/${mixed}`, 'tests did not pass'],
            [`#/runs/${mixed}/tests/0`, /30 values/],
            [`#/runs/${signals}/tests/0`, /2000 samples/],
            [`#/runs/${mixed}/fixtures/0`, 'Start 1'],
        ]) {
            await guarded.page.evaluate((to) => (location.hash = to), hash);
            await guarded.see(ready);
            const [page, main] = await guarded.beyond();
            assert.equal(page, 0, `${hash}: the page itself does not scroll`);
            const isRun = hash !== '#/runs' && options === LAPTOP;
            if (isRun) assert.equal(main, 0, `${hash}: its parts scroll`);
            const detail = guarded.page.locator('#detail');
            if (!isRun) continue;
            const blank = await detail.evaluate((element) => {
                element.scrollTop = element.scrollHeight;
                if (element.scrollTop === 0) return 0;
                const { bottom } = element.getBoundingClientRect();
                return bottom - element.lastElementChild.getBoundingClientRect().bottom;
            });
            assert.ok(blank < 40, `${hash}: ${blank} px of nothing below the detail`);
        }
        await guarded.close();
    }
});

test('a run is found again, and the list stays where it was', async () => {
    const [mixed, broken] = names;
    const guarded = await open('#/runs', { viewport: { width: 900, height: 300 } });
    const { page } = guarded;
    await guarded.run(mixed).waitFor();
    await guarded.see('mixed', '.list');
    await page.getByLabel('Search runs').fill('broken');
    await guarded.run(mixed).waitFor({ state: 'detached' });
    assert.match(page.url(), /#\/runs\?q=broken$/);
    await page.reload();
    await guarded.run(broken).waitFor();
    assert.equal(await guarded.run(mixed).count(), 0);
    assert.equal(await page.getByLabel('Search runs').inputValue(), 'broken');
    await page.getByLabel('Result', { exact: true }).selectOption('green');
    await guarded.see('No run matches this filter.');
    await guarded.button('Show all').click();
    await guarded.run(mixed).waitFor();

    await page.evaluate(() => (location.hash = '#/runs?suite=mixed&result=good&commit=xyz'));
    await guarded.see(/“good” is no result/);
    await guarded.see(/“xyz” is no commit/);
    await guarded.run(mixed).waitFor();
    assert.equal(await guarded.run(broken).count(), 0, 'the rest of the filter holds');

    await page.evaluate(() => (location.hash = '#/runs'));
    await guarded.run(mixed).scrollIntoViewIfNeeded();
    const scrolled = () => page.evaluate(() => document.getElementById('main').scrollTop);
    const before = await scrolled();
    assert.ok(before > 0);
    await guarded.run(mixed).click();
    await guarded.rowIs('Fails', 'failed');
    await page.goBack();
    await guarded.run(mixed).waitFor();
    assert.equal(await scrolled(), before);
    await guarded.close();
});

test('a test is read: its command, its messages, their moments', async () => {
    const [mixed] = names;
    const guarded = await open(`#/runs/${mixed}/tests/0`, {
        ...LAPTOP,
        permissions: ['clipboard-read', 'clipboard-write'],
    });
    const { page } = guarded;
    await guarded.button('Copy the command').click();
    await guarded.see('Copied');
    const copied = await page.evaluate(() => navigator.clipboard.readText());
    assert.equal(copied, 'rtf run suite.xml::Measures');
    await guarded.see('load', '#detail [aria-label=Phases]');

    await step('the moment of a message is marked in the timeline', async () => {
        await guarded.button('Fold the timeline').click();
        await page.getByRole('region', { name: /drawn/ }).waitFor({ state: 'detached' });
        await page
            .getByRole('button', { name: /show in the timeline/ })
            .first()
            .click();
        await page.locator('.timeline .mark').waitFor();
    });

    await step('what is folded leaves its room to the detail, also after a reload', async () => {
        const height = () => page.locator('#detail').evaluate((each) => each.clientHeight);
        const before = await height();
        await guarded.button('Fold the timeline').click();
        await guarded.button('Fold the summary').click();
        await page.reload();
        await guarded.see(/30 values/);
        assert.ok((await height()) > before + 100, `${before} px, then ${await height()} px`);
        await guarded.button('Show the summary').click();
        await guarded.button('Show the timeline').click();
        await page.locator('.chips').waitFor();
    });
    await guarded.close();
});

test('signals: values under the cursor, one plot for several, every sample of a part', async () => {
    const guarded = await open(`#/runs/${names[2]}/tests/0`);
    const { page } = guarded;
    const plots = page.getByRole('img', { name: /over time$/ });
    await guarded.see(/2000 samples/);
    assert.equal(await plots.count(), 2);
    await guarded.see(/mean/, 'section[aria-label=Signals]');
    const box = await plots.first().boundingBox();
    const at = (share) => [box.x + 80 + (box.width - 90) * share, box.y + box.height / 2];
    await page.mouse.move(...at(0.5));
    // All plots share one cursor.
    for (const bar of await page.locator('.plot .bar').all())
        await bar.getByText(/^[\d.]+ s$/).waitFor();

    const part = page.waitForResponse((answer) => /series\?from=/.test(answer.url()));
    await page.mouse.down();
    await page.mouse.move(...at(0.6), { steps: 4 });
    await page.mouse.up();
    const { series } = await (await part).json();
    const [low, high] = [series[0].times[0], series[0].times.at(-1)];
    const wanted = Math.round((high - low) / 0.005) + 1;
    assert.equal(series[0].times.length, wanted, 'no sample of the part is missing');
    // Both show the same part, and one button resets both.
    assert.equal(await guarded.button('Reset zoom').count(), 2);
    await guarded.button('Reset zoom').first().click();
    assert.equal(await guarded.button('Reset zoom').count(), 0);

    for (const name of ['sine', 'ramp']) await page.getByLabel(`overlay ${name}`).check();
    await page.getByRole('img', { name: 'sine, ramp over time' }).waitFor();
    assert.equal(await plots.count(), 1);
    await guarded.close();
});

test('eight tabs follow one run, and hidden ones do not', async (context) => {
    const waiting = await Bench.make();
    context.after(() => waiting.close());
    const run = await waiting.run(WAITING);
    const first = await Guarded.open(browser, run.url);
    await first.rowIs('First', 'running');
    const tabs = [];
    for (let tab = 0; tab < 7; tab += 1) tabs.push(await first.tab(run.origin));
    for (const tab of tabs) {
        await tab.rowIs('First', 'running');
        await tab.see('live', '.connection');
    }
    await step('a hidden tab follows no longer, and is up to date when it is seen', async () => {
        const [hidden] = tabs;
        await hidden.hide(true);
        await hidden.see('paused while hidden', '.connection');
        await first.row('First').click();
        await first.button('Stop the test').click();
        await first.button('Yes, stop the test').click();
        for (const tab of [first, ...tabs.slice(1)]) await tab.rowIs('First', 'interrupted');
        await hidden.rowIs('First', 'running');
        await hidden.hide(false);
        await hidden.rowIs('First', 'interrupted');
    });
    await first.close();
});

test('when the server of a run has ended, what was loaded stays', async (context) => {
    const ending = await Bench.make();
    context.after(() => ending.close());
    const run = await ending.run(WAITING);
    const guarded = await Guarded.open(browser, run.url);
    await guarded.rowIs('First', 'running');
    await guarded.row('First').click();
    await guarded.see('the arm is ready for never');
    await guarded.see('waiting', '.output');
    await guarded.button('Stop the run').click();
    await guarded.button('Yes, stop the run').click();
    await guarded.rowIs('First', 'interrupted');
    await within('the end of the run', run.ended);
    await guarded.see(/The run has ended, and its server has exited/);
    await guarded.see('rtf serve');
    await guarded.row('Second').click();
    await guarded.see('skipped', '#detail');
    await guarded.row('First').click();
    await guarded.see('the arm is ready for never');
    await guarded.see('waiting', '.output');
    assert.equal(await guarded.page.getByText('No output').count(), 0);
    assert.equal(await guarded.page.getByText('the server does not answer').count(), 0);
    await guarded.close();
});
