// Measures the page in a real Chromium, for benches/lines/page.py:
//
//   node measure.mjs URL TEST     the test with this name reports `tick SECONDS`;
//                                 without a test, latencies are not measured
//
// Prints one line of JSON, in milliseconds: how long it takes until the list of
// tests is there when the page is opened, and drawn when it is opened again; how
// late ticks are on the screen, and the frames while the list is scrolled.

import { Guarded, launch } from './support/browser.mjs';

const TICKS = 30;
const FRAMES = 120;
/** A million reports precede the first tick. */
const START_MS = 120_000;

const [url, test] = process.argv.slice(2);
const browser = await launch();
const guarded = await Guarded.open(browser, url);
const { page } = guarded;
await page.getByRole('treeitem').first().waitFor();
const opened = await page.evaluate(() => performance.now());
const results = {
    opened,
    // First, because it waits for everything that precedes the ticks.
    lateness: test ? await lateness() : [],
    paint: await paint(),
    frames: await frames(),
};
await guarded.close();
await browser.close();
process.stdout.write(`${JSON.stringify(results)}\n`);

/** From the start of a reload until a row of the list has been drawn. */
async function paint() {
    await page.addInitScript(() => {
        addEventListener('DOMContentLoaded', () => {
            const drawn = () => setTimeout(() => (globalThis.drawnAt = performance.now()));
            const look = () => {
                const isThere = document.querySelector('[role=treeitem]') !== null;
                requestAnimationFrame(isThere ? drawn : look);
            };
            look();
        });
    });
    await page.reload();
    await page.waitForFunction(() => globalThis.drawnAt !== undefined);
    return page.evaluate(() => globalThis.drawnAt);
}

/** From the plug-in's report until it is drawn. */
async function lateness() {
    await page.getByLabel('Search tests').fill(test);
    await page.getByRole('treeitem').filter({ hasText: test }).click();
    await page
        .getByText(/^tick \d/)
        .first()
        .waitFor({ timeout: START_MS });
    const found = await page.evaluate(watchTicks, TICKS);
    await page.getByLabel('Search tests').fill('');
    return found;
}

/** In the page: the latency of each of the next ticks. */
function watchTicks(wanted) {
    const late = [];
    let last = Date.now();
    return new Promise((resolve) => {
        const look = () => {
            const rows = [...document.querySelectorAll('#detail li')].slice(-5);
            const times = rows
                .map((row) => Number(/tick ([\d.]+)/.exec(row.textContent)?.[1]) * 1000)
                .filter((time) => time > last);
            last = Math.max(last, ...times);
            // Changes before a frame are visible at its end.
            setTimeout(() => {
                late.push(...times.map((time) => Date.now() - time));
                if (late.length < wanted) requestAnimationFrame(look);
                else resolve(late);
            });
        };
        requestAnimationFrame(look);
    });
}

/** Frame times while the whole list is scrolled. */
function frames() {
    return page.evaluate(
        (wanted) =>
            new Promise((resolve) => {
                const list = document.querySelector('[role=tree]');
                const times = [];
                let last = performance.now();
                const step = (now) => {
                    times.push(now - last);
                    last = now;
                    list.scrollTop = (list.scrollHeight * (times.length % wanted)) / wanted;
                    if (times.length <= wanted) requestAnimationFrame(step);
                    else resolve(times.slice(1));
                };
                requestAnimationFrame(step);
            }),
        FRAMES,
    );
}
