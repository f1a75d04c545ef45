// Measures in a real Chromium how long the History page takes to open:
//
//   node measure-history.mjs URL [TIMES]
//
// Prints one line of JSON: milliseconds from the navigation until the matrix is drawn, the first
// time with an empty cache, and the number of rows when all are loaded.

import { Guarded, launch } from './support/browser.mjs';

const [url, times = '5'] = process.argv.slice(2);
const browser = await launch();
const drawn = [];
let rows = 0;
for (let time = 0; time < Number(times); time += 1) {
    const guarded = await Guarded.open(browser, 'about:blank');
    const { page } = guarded;
    guarded.watch(new URL(url).origin);
    await page.addInitScript(() => {
        const look = () => {
            const isThere = document.querySelector('canvas[data-rows]') !== null;
            // After the frame in which it is drawn.
            if (isThere) setTimeout(() => (globalThis.drawnAt = performance.now()));
            else requestAnimationFrame(look);
        };
        requestAnimationFrame(look);
    });
    await page.goto(`${new URL(url).origin}/#/history`);
    await page.waitForFunction(() => globalThis.drawnAt !== undefined);
    drawn.push(await page.evaluate(() => globalThis.drawnAt));
    await page.getByText('Loading more …').waitFor({ state: 'hidden' });
    rows = await page.locator('canvas[data-rows]').evaluate((canvas) => canvas.dataset['rows']);
    await guarded.context.close();
}
await browser.close();
process.stdout.write(`${JSON.stringify({ drawn, rows: Number(rows) })}\n`);
