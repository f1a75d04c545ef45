// Makes the pictures of the page for the documentation:
//
//   node screenshots.mjs DIR
//
// Example 02 runs until its arm has died and was restarted; then a
// small suite with every kind of result.

import { cp } from 'node:fs/promises';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { Guarded, launch } from './support/browser.mjs';
import { Bench } from './support/rtf.mjs';
import { MIXED } from './support/suites.mjs';

const EXAMPLES = fileURLToPath(new URL('../../examples/', import.meta.url));
const EXAMPLE = 'examples/02-supervised-simulator/supervised.xml';
/** The simulator starts slowly on a busy machine. */
const EXAMPLE_MS = 60_000;
const dir = process.argv[2];
const browser = await launch();
const bench = await Bench.make();
const wide = { viewport: { width: 1280, height: 800 }, colorScheme: 'light' };
const narrow = { viewport: { width: 390, height: 780 }, colorScheme: 'dark' };

try {
    await takeLive();
    await takePast();
} finally {
    await browser.close();
    await bench.close();
}

async function takeLive() {
    await cp(EXAMPLES, path.join(bench.dir, 'examples'), { recursive: true });
    const run = await bench.start(['run', '--web=127.0.0.1:0', EXAMPLE]);
    const live = await Guarded.open(browser, run.url, wide);
    live.page.setDefaultTimeout(EXAMPLE_MS);
    await live.see('passed', '.chips');
    await save(live, 'live');
    const phone = await Guarded.open(browser, run.url, narrow);
    phone.page.setDefaultTimeout(EXAMPLE_MS);
    await phone.see('passed', '.chips');
    await save(phone, 'phone');
    await run.ended;
    await phone.close();
    await live.close();
}

async function takePast() {
    await bench.runToEnd(MIXED);
    await bench.runToEnd(MIXED.replace('param="fail"', 'param="error"'));
    const serve = await bench.serve();
    const past = await Guarded.open(browser, serve.url, { ...wide, colorScheme: 'dark' });
    const [, old, now] = await bench.names();
    await visit(past, `#/runs/${old}/tests/0`, /30 values/, 'test');
    await visit(past, `#/compare/${old}/${now}`, 'Two runs compared', 'compare');
    await past.close();
}

async function visit(past, hash, ready, name) {
    await past.page.evaluate((to) => (location.hash = to), hash);
    await past.see(ready);
    await save(past, name);
}

async function save({ page }, name) {
    await page.evaluate(() => document.fonts.ready);
    await page.getByText('Loading …').waitFor({ state: 'hidden' });
    await page.screenshot({ path: path.join(dir, `${name}.png`) });
}
