// The page by keyboard, on a narrow screen, and for assistive technology.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { violations } from './support/axe.mjs';
import { Guarded, launch } from './support/browser.mjs';
import { Bench } from './support/rtf.mjs';
import { MIXED } from './support/suites.mjs';

let browser;
let bench;
let serve;
let names;

before(async () => {
    browser = await launch();
    bench = await Bench.make();
    await bench.runToEnd(MIXED);
    await bench.runToEnd(MIXED);
    serve = await bench.serve();
    names = await bench.names();
});
after(async () => {
    await browser.close();
    await bench.close();
});

/** Each view of the page: its address, and a text that is visible when it is drawn. */
function places() {
    const [old, now] = names;
    const run = `#/runs/${now}`;
    return [
        { name: 'runs', hash: '#/runs', ready: now },
        { name: 'filtered runs', hash: '#/runs?suite=mixed&result=red&since=x', ready: now },
        { name: 'a run', hash: run, ready: 'tests did not pass' },
        { name: 'a test with plots', hash: `${run}/tests/0`, ready: /30 values/ },
        { name: 'a repeated test', hash: `${run}/tests/1?attempt=2`, ready: /30 values/ },
        { name: 'a failed test', hash: `${run}/tests/2`, ready: /outside its limits/ },
        { name: 'a fixture', hash: `${run}/fixtures/0`, ready: 'Start 1' },
        { name: 'a hook', hash: `${run}/hooks/0`, ready: 'parked' },
        { name: 'a comparison', hash: `#/compare/${old}/${now}`, ready: 'Two runs compared' },
    ];
}

async function goTo(guarded, { hash, ready }) {
    await guarded.page.evaluate((to) => (location.hash = to), hash);
    await guarded.page.getByText(ready).first().waitFor({ state: 'attached' });
}

for (const colorScheme of ['light', 'dark']) {
    for (const width of [1280, 390]) {
        test(`nothing is seriously wrong for axe: ${colorScheme}, ${width} px`, async () => {
            const viewport = { width, height: 860 };
            const guarded = await Guarded.open(browser, serve.url, { colorScheme, viewport });
            for (const place of places()) {
                await goTo(guarded, place);
                assert.deepEqual(await violations(guarded), [], place.name);
            }
            await guarded.page.evaluate((run) => (location.hash = `#/runs/${run}`), names[1]);
            await guarded.button('Table').click();
            await guarded.page.getByRole('table', { name: 'Timeline' }).waitFor();
            assert.deepEqual(await violations(guarded), [], 'the timeline as a table');
            await guarded.close();
        });
    }
}

test('a width of 390 px is sufficient', async () => {
    const viewport = { width: 390, height: 844 };
    const guarded = await Guarded.open(browser, serve.url, { viewport, hasTouch: true });
    for (const place of places()) {
        await goTo(guarded, place);
        const width = await guarded.page.evaluate(() => {
            const main = document.getElementById('main');
            return Math.max(document.documentElement.scrollWidth, main.scrollWidth);
        });
        assert.ok(width <= 390, `${place.name} is ${width} px wide`);
    }
    await guarded.page.evaluate((run) => (location.hash = `#/runs/${run}`), names[1]);
    await guarded.row('Fails').tap();
    await guarded.see(/elbow/, '#detail');
    await guarded.page.getByRole('link', { name: '← Overview' }).tap();
    await guarded.see('tests did not pass');
    await guarded.close();
});

test('light and dark theme: the system default, or the choice of the user', async () => {
    const guarded = await Guarded.open(browser, serve.url, { colorScheme: 'dark' });
    const background = () =>
        guarded.page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    await guarded.see('Runs');
    const dark = await background();
    await guarded.button('Light').click();
    const light = await background();
    assert.notEqual(light, dark);
    await guarded.page.reload();
    assert.equal(await background(), light);
    await guarded.button('As the system').click();
    assert.equal(await background(), dark);
    await guarded.close();
});

test('every function works with the keyboard', async () => {
    const guarded = await Guarded.open(browser, serve.url);
    const { page } = guarded;
    const { keyboard } = page;
    const focused = () => page.evaluate(() => document.activeElement.getAttribute('aria-label'));
    const tabTo = async (label) => {
        for (let step = 0; step < 40; step += 1) {
            if ((await focused()) === label) return;
            await keyboard.press('Tab');
        }
        assert.fail(`Tab does not lead to ${label}`);
    };

    // Select two runs and compare them.
    for (const name of names) {
        await tabTo(`Compare ${name}`).catch(() => keyboard.press('Home'));
        await page.getByLabel(`Compare ${name}`).focus();
        await keyboard.press('Space');
    }
    await page.getByRole('link', { name: 'Compare the two' }).focus();
    await keyboard.press('Enter');
    await guarded.see('Two runs compared');

    // Search for a test, and open it.
    await page.locator(`main a[href$="${names[1]}"]`).first().focus();
    await keyboard.press('Enter');
    await guarded.rowIs('Fails', 'failed');
    await keyboard.press('/');
    await keyboard.type('fails');
    await guarded.see('1 of 5', '.search');
    await tabTo('Suites and tests');
    await keyboard.press('ArrowDown');
    await keyboard.press('Enter');
    await guarded.see(/elbow/, '#detail');
    assert.match(page.url(), /tests\/2$/);
    await keyboard.press('ArrowUp');
    await keyboard.press('ArrowLeft');
    await page.getByRole('treeitem', { expanded: false }).waitFor();

    // Zoom the timeline, and read it as a table.
    const range = page.locator('.range');
    const whole = await range.innerText();
    await page.getByRole('region', { name: /^Timeline, drawn/ }).focus();
    await keyboard.press('+');
    await guarded.page.waitForFunction(
        (text) => document.querySelector('.range').innerText !== text,
        whole,
    );
    await keyboard.press('0');
    await guarded.see(whole, '.range');
    await guarded.button('Table').focus();
    await keyboard.press('Enter');
    await page.getByRole('table', { name: 'Timeline' }).waitFor();

    // A link skips the header.
    await page.reload();
    await keyboard.press('Tab');
    assert.equal(
        await page.evaluate(() => document.activeElement.textContent),
        'Skip to the content',
    );
    await guarded.close();
});
