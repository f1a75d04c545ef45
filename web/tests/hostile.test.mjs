// Names, messages, output and attachments are always shown as text.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { after, before, test } from 'node:test';
import { Guarded, launch } from './support/browser.mjs';
import { Bench } from './support/rtf.mjs';
import { HOSTILE } from './support/suites.mjs';

/** A stored stream of events, with fixtures that provide values. */
const VALUES = new URL('../../crates/rtf-report/tests/streams/values.jsonl', import.meta.url);

let browser;
let bench;
let guarded;

before(async () => {
    browser = await launch();
    bench = await Bench.make();
    await bench.runToEnd(HOSTILE);
    const lines = (await readFile(VALUES, 'utf8')).trimEnd().split('\n');
    await bench.journal(
        'values',
        lines.map((line) => JSON.parse(line)),
    );
    const serve = await bench.serve();
    guarded = await Guarded.open(browser, serve.url);
    const [name] = await bench.names();
    await guarded.run(name).click();
});
after(async () => {
    await guarded.close();
    await browser.close();
    await bench.close();
});

const SCRIPT = '<script>alert(1)</script>';

/** Asserts that the page has no other scripts than its own two, which are files of this server. */
async function assertOwnScripts(page) {
    const sources = await page
        .locator('script')
        .evaluateAll((scripts) =>
            scripts.map((script) => script.getAttribute('src') ?? script.text),
        );
    assert.equal(sources.length, 2, sources.join(' '));
    assert.equal(sources[0], './early.js');
    assert.match(sources[1], /^\.\/assets\/[\w.-]+\.js$/);
}

test('names are text', async () => {
    await guarded.see(`<b> "quoted" 'suite' &amp;`, '[role=tree]');
    await guarded.see('<img src=x onerror=alert(1)>', 'article');
    await guarded.see(SCRIPT, '[role=tree]');
    // Characters that change the text direction are spelled out.
    await guarded.see('größe 🤖 ⟨U+202E⟩gnp.exe', '[role=tree]');
    await guarded.see(SCRIPT, 'article, #detail');
});

test('search takes characters as they are', async () => {
    const search = guarded.page.getByLabel('Search tests');
    await search.fill('<script>');
    await guarded.see('1 of 2', '.search');
    await search.fill('(.*');
    await guarded.see('No test matches.');
    await search.fill('tag:<i>tag');
    await guarded.see('1 of 2', '.search');
    await search.fill('');
});

test('messages, measurements and output are text', async () => {
    await guarded.row(SCRIPT).click();
    await guarded.see(`<script>alert('x')</script><img src=x onerror=alert(1)>`, '#detail li');
    await guarded.see('<b>bold</b>');
    const output = guarded.page.getByRole('log', { name: 'Output', exact: true });
    await output.press('Home');
    const rows = output.locator('.row');
    await rows.filter({ hasText: `<script>alert('x')</script>` }).waitFor();
    const red = rows.locator('.ansi-red');
    assert.equal(await red.innerText(), 'red');
    await rows.filter({ hasText: /red {2}\s*after/ }).waitFor();
    await rows.filter({ hasText: 'nul:⟨NUL⟩: right-to-left:⟨U+202E⟩gnp.exe emoji:🤖' }).waitFor();
});

test('a line of a megabyte is shown, piece by piece', async () => {
    const output = guarded.page.getByRole('log', { name: 'Output', exact: true });
    const drawn = await output.locator('.row').count();
    assert.ok(drawn < 100, `${drawn} rows are drawn`);
    await output.press('End');
    await output.locator('.row').filter({ hasText: 'the last line' }).waitFor();
    const long = await output.locator('.row').filter({ hasText: /^↳x+$/ }).count();
    assert.ok(long > 5, 'it continues over several rows');
});

test('an attached page is not opened in this origin', async () => {
    const link = guarded.page.getByRole('link', { name: '<svg onload=alert(1)>.html' });
    const url = await link.getAttribute('href');
    const answer = await guarded.page.request.get(new URL(url, guarded.page.url()).href);
    assert.equal(answer.status(), 200);
    assert.match(answer.headers()['content-disposition'], /^attachment/);
    assert.match(answer.headers()['content-security-policy'], /sandbox/);
    assert.equal(answer.headers()['content-type'], 'application/octet-stream');
});

test('none of it became a part of the page', async () => {
    const { page } = guarded;
    await assertOwnScripts(page);
    assert.equal(await page.locator('main b, main i, main img').count(), 0);
    assert.equal(await page.locator('[onerror], [onload]').count(), 0);
});

test('values of fixtures are text, and a secret is labelled', async () => {
    const { page } = guarded;
    await page.evaluate(() => (location.hash = '#/runs/values/fixtures/1'));
    const values = page.getByLabel('Values', { exact: true });
    await values.waitFor();
    assert.equal(await values.locator('dt').first().innerText(), 'token');
    assert.equal(await values.locator('dd').first().innerText(), '*** secret');
    const texts = await values.locator('code').allInnerTexts();
    assert.equal(texts.length, 7);
    assert.equal(texts[1], '[-1.5,2,{"joint":"elbow"}]');
    assert.equal(
        texts[2],
        'Arm 3 <script>alert(1)</script>\nfirmware ⟨ESC⟩[31m7.1⟨ESC⟩[0m & "quotes"\n\n' +
            "  calibrated with ]]> & 'größe' 🤖 ⟨U+202E⟩gnp.exe",
    );
    const isWrapped = await values.evaluate((list) => list.scrollWidth <= list.clientWidth);
    assert.ok(isWrapped, 'long values are wrapped');
    await assertOwnScripts(page);
});
