// A report in one HTML file, opened from the disk: all of a run, and nothing from elsewhere.

import assert from 'node:assert/strict';
import { readFile, stat } from 'node:fs/promises';
import { after, before, test } from 'node:test';
import { violations } from './support/axe.mjs';
import { Guarded, launch } from './support/browser.mjs';
import { Bench } from './support/rtf.mjs';
import { HOSTILE, MIXED, SIGNALS } from './support/suites.mjs';

/** The size of the page without data. */
const PAGE_BYTES = 1.5e6;

let browser;
let bench;
/** The report of a red run. */
let red;
let name;

before(async () => {
    browser = await launch();
    bench = await Bench.make();
    await bench.runToEnd(MIXED, '--report', 'html=out/red.html');
    red = bench.fileUrl('out/red.html');
    [name] = await bench.names();
});
after(async () => {
    await browser.close();
    await bench.close();
});

/** Opens a report, and waits until its run is drawn. */
async function open(url, options = {}) {
    const guarded = await Guarded.open(browser, url, options);
    await guarded.page.locator('section.summary').waitFor();
    return guarded;
}

/** Closes a report, which may have requested only itself and these files. */
async function close(guarded, url, ...files) {
    const requested = guarded.requests.map((request) => request.url().split('#')[0]);
    const others = requested.filter((each) => each !== url && !each.startsWith('data:'));
    assert.deepEqual(
        others.map((each) => new URL(each).pathname.split('/').at(-1)),
        files,
    );
    await guarded.close();
}

/** The data of a report, and the page without it. */
async function partsOf(url) {
    const html = await readFile(new URL(url), 'utf8');
    const start = html.indexOf('<script type="application/gzip"');
    const end = html.lastIndexOf('</script>\n') + '</script>\n'.length;
    return { data: html.slice(start, end), page: html.slice(0, start) + html.slice(end) };
}

test('a red run: verdicts, messages, plots, attachments and output', async () => {
    const guarded = await open(red);
    const { page } = guarded;
    await guarded.see('3 tests did not pass');
    for (const [test, verdict] of [
        ['Measures', 'passed'],
        ['Repeats', 'passed'],
        ['Fails', 'failed'],
        ['Errs', 'failed'],
        ['Crashes', 'crashed'],
    ])
        await guarded.rowIs(test, verdict);
    assert.match(await page.title(), /^finished · .* · rtf$/);

    await guarded.row('Measures').click();
    await guarded.see('the arm is ready for through');
    await guarded.see('30 values');
    await page.locator('#detail .uplot canvas').first().waitFor();
    const picture = page.getByRole('img', { name: 'camera' });
    await picture.scrollIntoViewIfNeeded();
    await picture.evaluate((image) => image.decode());
    assert.equal(await picture.evaluate((image) => image.naturalWidth), 48);
    await guarded.see('waiting for through', '.output');
    await guarded.see('rtf run suite.xml::Measures', '#detail');

    await guarded.row('Fails').click();
    await guarded.see(/elbow/, '#detail');
    await guarded.see(/outside its limits/, '#detail');
    await guarded.row('Repeats').click();
    await page.getByRole('navigation', { name: 'Attempts' }).getByRole('link').nth(1).click();
    await guarded.see('the arm is ready for through');
    await page.evaluate((run) => (location.hash = `#/runs/${run}/fixtures/0`), name);
    await guarded.see('Start 1');
    // The output starts at its end, and a slow run has more of it than is visible.
    await page.getByRole('log', { name: 'Output of simulator' }).press('Home');
    await guarded.see('the simulator is up', '.output');
    await page.evaluate((run) => (location.hash = `#/runs/${run}/hooks/0`), name);
    await guarded.see('parked');
    await close(guarded, red);
});

test('there is nothing of a server', async () => {
    const guarded = await open(red);
    const { page } = guarded;
    for (const word of ['Runs', 'API', 'whole log', 'events.jsonl'])
        assert.equal(await page.getByRole('link', { name: word }).count(), 0, word);
    for (const label of ['Control …', 'Stop the run', 'Rerun failed tests'])
        assert.equal(await guarded.button(label).count(), 0, label);
    assert.equal(await page.locator('.connection').innerText(), '');
    await guarded.row('Fails').click();
    await guarded.see(/elbow/, '#detail');
    assert.equal(await page.getByRole('link', { name: 'whole log' }).count(), 0);
    assert.equal(await page.getByText(/server/).count(), 0);
    // Other addresses lead to the run, or back to it.
    for (const hash of ['#/runs', '#/compare/a/b', '#/']) {
        await page.evaluate((to) => (location.hash = to), hash);
        await guarded.see('3 tests did not pass');
    }
    await page.evaluate(() => (location.hash = '#/runs/another'));
    await guarded.see(/this report has only the run/);
    await page.getByRole('link', { name: 'The run of this report' }).click();
    await guarded.see('3 tests did not pass');
    await close(guarded, red);
});

test('signals are plotted, and can be enlarged', async () => {
    await bench.runToEnd(SIGNALS);
    const url = await bench.report('latest', 'signals.html');
    const guarded = await open(url);
    await guarded.row('Samples').click();
    const signals = guarded.page.getByRole('region', { name: 'Signals' });
    await signals.getByText('2000 samples').first().waitFor();
    const plots = signals.locator('.uplot .u-over');
    assert.equal(await plots.count(), 2);
    const { x, y, width, height } = await plots.first().boundingBox();
    await guarded.page.mouse.move(x + width * 0.2, y + height / 2);
    await guarded.page.mouse.down();
    await guarded.page.mouse.move(x + width * 0.4, y + height / 2, { steps: 4 });
    await guarded.page.mouse.up();
    await guarded.button('Reset zoom').first().waitFor();
    await close(guarded, url);
});

test('merged runs are in one report', async () => {
    const suite = (word) => `<suite name="${word}">
      <test type="python" name="In ${word}" param="through">Step</test>
    </suite>`;
    const merging = await Bench.make();
    for (const word of ['left', 'right']) await merging.runToEnd(suite(word));
    const merged = merging.spawn(['merge', ...(await merging.names())]);
    assert.equal(await merged.ended, 0, merged.printed);
    const url = await merging.report('latest');
    const guarded = await open(url);
    await guarded.see('2 of 2', 'section.summary');
    for (const word of ['left', 'right']) {
        await guarded.row(`In ${word}`).click();
        await guarded.see(`In ${word}`, '#detail h1');
        await guarded.see('the arm is ready for through', '#detail');
        const picture = guarded.page.getByRole('img', { name: 'camera' });
        await picture.scrollIntoViewIfNeeded();
        await picture.evaluate((image) => image.decode());
    }
    await close(guarded, url);
    await merging.close();
});

test('hostile text is text, and hostile files are downloads', async () => {
    await bench.runToEnd(HOSTILE);
    const url = await bench.report('latest', 'hostile.html');
    const guarded = await open(url);
    const { page } = guarded;
    const script = '<script>alert(1)</script>';
    await guarded.see(`<b> "quoted" 'suite' &amp;`, '[role=tree]');
    await guarded.row(script).click();
    await guarded.see(/end <\/script><\/style><!-- <!--rtf-data-->/, '#detail li');
    await guarded.see(`<script>alert('x')</script><img src=x onerror=alert(1)>`, '#detail li');
    assert.equal(await page.locator('main b, main i, main img, main script').count(), 0);
    assert.equal(await page.locator('[onerror], [onload]').count(), 0);
    const link = page.getByRole('link', { name: '<svg onload=alert(1)>.html' });
    assert.match(await link.getAttribute('href'), /^data:application\/octet-stream;base64,/);
    assert.equal(await link.getAttribute('download'), '<svg onload=alert(1)>.html');
    await close(guarded, url);
    // Only the data differs from that of another run, and it is Base64.
    const [hostile, other] = await Promise.all([partsOf(url), partsOf(red)]);
    assert.equal(hostile.page, other.page);
    const block = /^<script type="application\/gzip" id="rtf-\w+">[A-Za-z0-9+/=]+<\/script>$/;
    for (const line of hostile.data.trimEnd().split('\n')) assert.match(line, block);
});

test('axe finds nothing serious', async () => {
    for (const colorScheme of ['light', 'dark']) {
        const guarded = await open(red, { colorScheme });
        for (const [hash, ready] of [
            ['', 'tests did not pass'],
            ['/tests/0', /30 values/],
            ['/tests/2', /outside its limits/],
            ['/fixtures/0', 'Start 1'],
        ]) {
            await guarded.page.evaluate((to) => (location.hash = to), `#/runs/${name}${hash}`);
            await guarded.page.getByText(ready).first().waitFor({ state: 'attached' });
            assert.deepEqual(await violations(guarded), [], hash);
        }
        await close(guarded, red);
    }
});

test('the page without data is small', async () => {
    const page = (await partsOf(red)).page.length;
    assert.ok(page < PAGE_BYTES, `${page} bytes`);
    const { size } = await stat(new URL(red));
    console.log(`the page: ${page} bytes; with a run of 5 tests: ${size} bytes`);
});
