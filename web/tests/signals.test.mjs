// What a test with signals shows: intervals of violated monitors and tubes in the plots, compared
// pictures next to each other, and the command that replays its recording. Also in a report.

import assert from 'node:assert/strict';
import { mkdir } from 'node:fs/promises';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from './support/axe.mjs';
import { Guarded, launch } from './support/browser.mjs';
import { Bench } from './support/rtf.mjs';
import { WATCHED } from './support/suites.mjs';

/** A level of 1 m for ten seconds. */
const STORED = `# rtf trajectory 1
# unit: m
time,value
0,1
10,1
`;

let browser;
let bench;
/** The page of the test, from a server and in a report. */
let addresses;

before(async () => {
    browser = await launch();
    bench = await Bench.make();
    await mkdir(path.join(bench.dir, 'golden'));
    await bench.write('golden/level.csv', STORED);
    await bench.write('suite.replay.xml', WATCHED);
    await bench.runToEnd(WATCHED);
    const [name] = await bench.names();
    const serve = await bench.serve();
    const place = `#/runs/${name}/tests/0`;
    addresses = [`${serve.origin}/${place}`, `${await bench.report(name)}${place}`];
});
after(async () => {
    await browser.close();
    await bench.close();
});

/** Opens the page of the test, without and with a server. */
async function onBothPages(look) {
    for (const address of addresses) {
        const options = {
            permissions: address.startsWith('http') ? ['clipboard-read', 'clipboard-write'] : [],
        };
        const guarded = await Guarded.open(browser, address, options);
        await guarded.page.getByRole('region', { name: 'Signals' }).waitFor();
        await look(guarded, address);
        await guarded.close();
    }
}

/** The times of the columns that are marked over their whole height, in the plot from 0 s to 10 s. */
function marked(canvas) {
    return canvas.evaluate((element) => {
        const area = element.parentElement.querySelector('.u-over').getBoundingClientRect();
        const whole = element.getBoundingClientRect();
        const scale = element.width / whole.width;
        const pixels = element.getContext('2d');
        const [left, top] = [(area.left - whole.left) * scale, (area.top - whole.top) * scale];
        const [width, height] = [Math.round(area.width * scale), Math.round(area.height * scale)];
        const { data } = pixels.getImageData(left, top, width, height);
        const isRed = (x, y) => {
            const at = 4 * (y * width + x);
            return data[at] > 150 && data[at] > data[at + 1] + 80 && data[at + 3] > 0;
        };
        const times = [];
        for (let x = 0; x < width; x += 1) {
            let red = 0;
            for (let y = 0; y < height; y += 1) red += isRed(x, y) ? 1 : 0;
            if (red > 0.8 * height) times.push((10 * x) / width);
        }
        return times;
    });
}

test('the interval of a violated monitor is marked in the plot, and named', async () => {
    await onBothPages(async (guarded) => {
        const section = guarded.page.getByRole('region', { name: 'Signals' });
        const named = await section.locator('p.bad').innerText();
        assert.match(named, /^monitor `not too high`: `level < 2m` does not hold/);
        const canvas = section.locator('canvas').first();
        await canvas.waitFor();
        await canvas.scrollIntoViewIfNeeded();
        // The monitor reports the first part of the violation, which begins after 4 s.
        const times = await marked(canvas);
        assert.ok(times.length > 0, 'no column is marked');
        assert.ok(
            times.every((time) => time > 3.9 && time < 4.2),
            `${times}`,
        );
    });
});

test('the plot of the violated monitor is directly below the reason', async () => {
    await onBothPages(async ({ page }) => {
        const section = page.getByRole('region', { name: 'Violated signals' });
        assert.equal(await section.getByRole('img').count(), 1);
        const reason = await section.evaluate(
            (element) => element.previousElementSibling.textContent,
        );
        // The test's own failure may arrive before the finding of the monitor.
        assert.match(reason, /monitor `not too high`|trajectory `level` leaves the tube/);
    });
});

test('the tube is in the plot of its signal, without a tick', async () => {
    await onBothPages(async (guarded) => {
        const section = guarded.page.getByRole('region', { name: 'Signals' });
        const plots = section.getByRole('img');
        assert.equal(await plots.count(), 1);
        const title = await plots.first().getAttribute('aria-label');
        assert.equal(title, 'level, trajectory/level/low, trajectory/level/high over time');
        assert.equal(await section.getByRole('checkbox').count(), 0);
        assert.deepEqual(await violations(guarded), []);
    });
});

test('a picture is next to its reference and the difference', async () => {
    await onBothPages(async (guarded) => {
        const { page } = guarded;
        const boxes = [];
        for (const name of ['scene', 'scene reference', 'scene difference']) {
            const picture = page.getByRole('img', { name, exact: true });
            await picture.scrollIntoViewIfNeeded();
            await picture.evaluate((image) => image.decode());
            assert.equal(await picture.evaluate((image) => image.naturalWidth), 64);
            boxes.push(await picture.boundingBox());
        }
        const [first, second, third] = boxes;
        assert.ok(first.x + first.width <= second.x && second.x + second.width <= third.x);
        assert.equal(first.y, third.y);
    });
});

test('the command that replays the recording is copied', async () => {
    await onBothPages(async (guarded, address) => {
        const { page } = guarded;
        await guarded.see(/^rtf run suite\.replay\.xml::Watched --set 'recording=/, '#detail');
        const button = page.getByRole('button', { name: 'Copy the command: Replay' });
        await button.click();
        if (!address.startsWith('http')) return;
        await page.getByText('Copied', { exact: true }).waitFor();
        const copied = await page.evaluate(() => navigator.clipboard.readText());
        assert.match(
            copied,
            /^rtf run suite\.replay\.xml::Watched --set 'recording=.*data\.mcap'$/,
        );
    });
});
