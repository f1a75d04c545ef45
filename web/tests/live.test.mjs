// A live run: from its start over a collapse to its end, with
// reloads, two browsers, and an interrupted network.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Guarded, launch } from './support/browser.mjs';
import { Network } from './support/network.mjs';
import { Bench, step, within } from './support/rtf.mjs';
import { ARM } from './support/suites.mjs';

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

/** The text of the page, without changing times. */
async function told({ page }) {
    const tree = await page.getByRole('tree').innerText();
    const detail = await page.locator('#detail').innerText();
    return (
        `${tree}\n${detail}`
            .replace(/[\d.]+ m?s\b/g, 'TIME')
            .replace(/step \d+/g, '')
            // Only the first browser has the token.
            .replace('Stop the test', '')
            .replace(/\s+/g, ' ')
    );
}

test('a run is watched live', async (context) => {
    const run = await bench.run(ARM);
    const network = await Network.make();
    context.after(() => network.cut());
    const first = await Guarded.open(browser, run.url, network.options);
    const { page } = first;
    let second;

    await step('the token is taken out of the address', async () => {
        await first.rowIs('Sweep', 'running');
        assert.ok(!page.url().includes('token'), page.url());
        await first.rowIs('Grip', 'pending');
        await first.see('0 of 2', 'section.summary');
        await first.see('ready', 'article');
        // The private resources of the suite, and how to join it, are folded.
        const resources = page.getByText('Private resources');
        assert.ok(!(await page.getByText(/^ROS_DOMAIN_ID=/).isVisible()));
        await resources.click();
        await first.see(/^ROS_DOMAIN_ID=\d+$/, 'article');
        await first.see(/^export .*ROS_DOMAIN_ID=/, 'article');
    });

    await step('what a test says comes as it says it', async () => {
        await first.row('Sweep').click();
        await first.see('the arm is ready for sweep');
        await first.see('waiting', '.output');
        assert.equal(await page.getByText('one more line').count(), 0);
        await bench.open('sweep-more');
        await first.see('one more line', '.output');
        await first.see('one more message');
        await first.see(/30 values/);
        const picture = page.getByRole('img', { name: 'camera' });
        await picture.waitFor();
        assert.equal(await picture.evaluate((image) => image.naturalWidth), 48);
        await first.see('Meanwhile, fixture');
        await first.see(/^step$/, '.output');
    });

    await step('a collapse, the restart and the rerun', async () => {
        const fixture = await first.tab(page.url().replace(/\/tests\/.*/, '/fixtures/0'));
        const values = fixture.page.getByLabel('Values', { exact: true });
        await values.getByText('40001', { exact: true }).waitFor();
        await bench.open('kill');
        await first.see('attempt 2');
        await values.getByText('40002', { exact: true }).waitFor();
        await fixture.page.close();
        await first.rowIs('Sweep', 'running');
        await page.getByRole('link', { name: 'collapsed attempt 1' }).click();
        await first.see(/fixture `simulator` collapsed/, '#detail');
        await page.getByRole('link', { name: 'running attempt 2' }).click();
        await first.button('Table').click();
        await first.see(/^collapsed: .*SIGKILL/, '.timeline');
        await first.see('restarted: start 2', '.timeline');
        // Output is left out of the stream while no page shows it; other events are not.
        await page.getByRole('link', { name: '← Overview' }).click();
        await first.see('ready', 'article');
        await first.row('Sweep').click();
        await first.button('Table').click();
    });

    await step('a reload loses nothing', async () => {
        await first.seeAttempt();
        const before = await told(first);
        await page.reload();
        await first.seeAttempt();
        assert.equal(await told(first), before);
    });

    await step('a second browser sees the same', async () => {
        const other = await launch();
        context.after(() => other.close());
        second = await Guarded.open(other, page.url());
        await second.seeAttempt();
        assert.equal(await told(second), await told(first));
    });

    await step('a cut network is told, and made up for', async () => {
        const snapshots = () =>
            first.requests.filter((each) => each.url().endsWith('/snapshot')).length;
        const known = snapshots();
        await network.cut();
        await first.see(/not connected/);
        await bench.open('sweep');
        // The second browser proves that the run has continued.
        await second.rowIs('Grip', 'running');
        await first.rowIs('Sweep', 'running');
        await network.join();
        await first.rowIs('Sweep', 'passed');
        await first.rowIs('Grip', 'running');
        await first.see('live', '.connection');
        assert.equal(snapshots(), known, 'it resumes without a new snapshot');
        // All pages share the stream: only the network shows which page requested it.
        const streams = network.requests.filter(({ url }) => url.includes('/events?'));
        assert.ok(Number(streams.at(-1).headers['last-event-id']) > 0);
    });

    await step('the end', async () => {
        await bench.open('grip', 'grip-more');
        for (const each of [first, second]) {
            await each.rowIs('Grip', 'passed');
            await each.see('green', 'section.summary');
            await each.see('2 of 2', 'section.summary');
        }
        assert.equal(await within('the end of the run', run.ended), 0);
        await first.see('one more message');
    });

    await second.close();
    await first.close();
});

test('the run is there afterwards', async () => {
    const serve = await bench.serve();
    const guarded = await Guarded.open(browser, serve.url);
    const [name] = await bench.names();
    await guarded.run(name).click();
    await guarded.rowIs('Sweep', 'passed');
    await guarded.see('flaky', '.tree');
    await guarded.see('simulator', 'article');
    await guarded.row('Sweep').click();
    await guarded.see('one more line', '.output');
    await guarded.close();
});
