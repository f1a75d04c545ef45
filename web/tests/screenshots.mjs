// Makes the pictures of the page for the documentation:
//
//   node screenshots.mjs DIR
//
// Example 02 runs until its arm has died and was restarted; then a
// small suite with every kind of result; then signals: example 11, and a golden trajectory.

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
/** The motion in docs/how-to/golden.md. */
const REACH = `import math
import os

import rtf


class ReachTest(rtf.TestCase):
    def run(self) -> None:
        gain = float(os.environ.get("GAIN", "1"))
        for step in range(300):
            time = step * 0.01
            angle = 1 - math.exp(-2 * gain * time)
            self.sample("elbow", angle, "rad", time=time)
        self.check_trajectory("elbow", "golden/reach.csv", tolerance=0.05)
`;
/** So high that parts of the page need no scrolling. */
const HIGH = { width: 1280, height: 2400 };
/** Parts are cut off below. */
const PART_PX = 420;
const dir = process.argv[2];
const browser = await launch();
const bench = await Bench.make();
const wide = { viewport: { width: 1280, height: 800 }, colorScheme: 'light' };
const narrow = { viewport: { width: 390, height: 780 }, colorScheme: 'dark' };

try {
    await takeLive();
    await takePast();
    await takeSignals();
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

async function takeSignals() {
    // The recorder of example 11 needs a library.
    process.env['RTF_PYTHON'] = process.env['RTF_MCAP_PYTHON'];
    const runs = (await bench.names()).length;
    await ended(['run', 'examples/11-signals/arm.xml']);
    await ended(['run', 'examples/11-signals/camera.xml']);
    await bench.write('ReachTest.py', REACH);
    await bench.write('reach.xml', '<suite name="arm"><test> ReachTest.py </test></suite>');
    await ended(['run', 'reach.xml']);
    await ended(['golden', 'accept', 'latest', 'ReachTest']);
    process.env['GAIN'] = '0.7';
    await ended(['run', 'reach.xml']);
    const serve = await bench.serve();
    const page = await Guarded.open(browser, serve.url, { ...wide, viewport: HIGH });
    const names = (await bench.names()).slice(runs);
    const [arm, camera, , golden] = names;
    await part(page, `#/runs/${arm}/tests/1`, 'Signals', 'monitor');
    await part(page, `#/runs/${camera}`, 'Timeline', 'fault');
    await part(page, `#/runs/${golden}/tests/0`, 'Signals', 'golden');
    await page.close();
}

/** A program that runs to its end, whatever its result. */
async function ended(args) {
    await bench.spawn(args).ended;
}

/** A picture of a part of a page. */
async function part(guarded, hash, name, file) {
    const { page } = guarded;
    await page.evaluate((to) => (location.hash = to), hash);
    const region = page.getByRole('region', { name, exact: true });
    await region.waitFor();
    await region.locator('canvas').first().waitFor();
    await page.evaluate(() => document.fonts.ready);
    const { x, y, width, height } = await region.boundingBox();
    const clip = { x, y, width, height: Math.min(height, PART_PX) };
    await page.screenshot({ path: path.join(dir, `${file}.png`), clip });
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
