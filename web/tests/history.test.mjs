// Results over time: the matrix, trends, flaky tests, and what is said without a history.

import assert from 'node:assert/strict';
import { rm, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from './support/axe.mjs';
import { Guarded, launch } from './support/browser.mjs';
import { Bench, step } from './support/rtf.mjs';
import { HOSTILE, MIXED } from './support/suites.mjs';

let browser;
let bench;
let serve;

before(async () => {
    browser = await launch();
    bench = await Bench.make();
    await bench.runToEnd(MIXED);
    await bench.runToEnd(MIXED);
    await bench.runToEnd(HOSTILE);
    serve = await bench.serve();
});
after(async () => {
    await browser.close();
    await bench.close();
});

const open = (hash, options) => Guarded.open(browser, `${serve.origin}/${hash}`, options);

test('the first requests are sent once, while the script is loaded', async () => {
    const guarded = await open('#/history');
    await guarded.see('7 tests, 3 runs');
    const paths = guarded.requests.map((request) => {
        const { pathname, search } = new URL(request.url());
        return pathname + search;
    });
    const early = ['/api/v1', '/api/v1/history/matrix?after=0&limit=60'];
    for (const one of early) assert.equal(paths.filter((each) => each === one).length, 1, one);
    const script = paths.findIndex((each) => each.endsWith('early.js'));
    assert.ok(script >= 0 && paths.indexOf(early[1]) > script);
    await guarded.close();
});

test('the matrix is read with the keyboard, and opens a test', async () => {
    const guarded = await open('#/history');
    const { page } = guarded;
    await guarded.see('7 tests, 3 runs');
    const matrix = page.getByRole('region', { name: /^Matrix of tests/ });
    await matrix.locator('canvas[data-rows="7"]').waitFor();
    await matrix.focus();
    await page.keyboard.press('Home');
    const cell = page.locator('.cell');
    const row = await cell.innerText();
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowDown');
    assert.notEqual(await cell.innerText(), row);
    await guarded.see('mixed/Errs', '.cell');
    await guarded.see('failed', '.cell strong');
    await page.getByLabel('Only tests with problems').check();
    await guarded.see('4 tests, 3 runs');
    await page.getByLabel('Only tests with problems').uncheck();
    await step('Enter opens the test, and back returns to the matrix', async () => {
        await matrix.focus();
        for (let times = 0; times < 7; times += 1) await page.keyboard.press('ArrowDown');
        await page.keyboard.press('Enter');
        await page.getByRole('img', { name: 'duration over run' }).waitFor();
        assert.match(page.url(), /#\/history\/test\?test=/);
        await page.goBack();
        await guarded.see('7 tests, 3 runs');
    });
    await guarded.close();
});

test('a test of a run leads to its history, with plots and limits', async () => {
    const [name] = await bench.names();
    const guarded = await open(`#/runs/${name}/tests/0`);
    const { page } = guarded;
    await page.locator('#detail').getByRole('link', { name: 'history', exact: true }).click();
    await guarded.see('mixed/Measures', 'h2');
    await guarded.see('2 passed');
    assert.ok((await page.getByRole('img', { name: / over run$/ }).count()) > 1);
    const results = page.getByRole('region', { name: 'Results' });
    assert.equal(await results.getByRole('row').count(), 3);
    await guarded.close();
});

test('lists, comparisons and filters have addresses', async () => {
    const guarded = await open('#/history/slow?filter=suite(mixed)');
    const { page } = guarded;
    const rows = page.getByRole('region', { name: 'Tests by duration' }).getByRole('row');
    await rows.nth(5).waitFor();
    assert.equal(await rows.count(), 6, 'five tests and a head');
    await page.getByLabel('Tests', { exact: true }).fill('name(Measures)');
    await guarded.button('Show').first().click();
    await rows.nth(5).waitFor({ state: 'detached' });
    assert.match(page.url(), /filter=name/);
    await page.getByRole('link', { name: 'Flaky' }).click();
    await guarded.see('No test both passed and failed on one commit, with equal sources, or');
    await guarded.see('without a commit or with uncommitted changes: 3 runs.');
    const [first, second] = await bench.names();
    await page.evaluate((to) => (location.hash = to), `#/history/compare?a=${first}&b=${second}`);
    await guarded.see('Also tests without differences');
    await page.getByLabel('Also tests without differences').check();
    await guarded.see('mixed/Repeats');
    await page.evaluate(() => (location.hash = '#/history?filter=tag('));
    await page.getByRole('alert').getByText('filter').waitFor();
    await guarded.close();
});

test('names are text', async () => {
    const guarded = await open('#/history/slow');
    await guarded.see('<script>alert(1)</script>', 'table');
    await guarded.page.getByRole('link', { name: '<script>alert(1)</script>' }).click();
    await guarded.see('<script>alert(1)</script>', 'h2');
    await guarded.close();
});

test('axe finds nothing serious, in both themes', async () => {
    for (const colorScheme of ['light', 'dark']) {
        const guarded = await open('#/history', { colorScheme });
        for (const [view, ready] of [
            ['', '7 tests, 3 runs'],
            ['/flaky', 'No test both'],
            ['/slow', 'mixed/Repeats'],
            ['/test?test=mixed%2FMeasures', '2 passed'],
            ['/compare?a=latest&b=latest', 'Also tests'],
            ['/trend', 'Measurement or signal'],
        ]) {
            await guarded.page.evaluate((to) => (location.hash = `#/history${to}`), view);
            await guarded.see(ready);
            assert.deepEqual(await violations(guarded), [], `${colorScheme} ${view}`);
        }
        await guarded.close();
    }
});

test('without a history, and with a damaged one, the page says what to do', async (context) => {
    const empty = await Bench.make();
    context.after(() => empty.close());
    await empty.runToEnd(MIXED, '--no-history');
    const server = await empty.serve();
    const guarded = await Guarded.open(browser, `${server.origin}/#/history`);
    await guarded.see(/rtf history import/, '[role=alert]');
    const database = path.join(empty.dir, 'rtf-results', 'history.db');
    await writeFile(
        database,
        'no database, but as long as a header of SQLite would have been, or so',
    );
    await guarded.page.reload();
    await guarded.see(/is damaged/, '[role=alert]');
    await rm(database);
    await guarded.close();
});
