// The page of one campaign, on a server and as a report in one file.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { violations } from './support/axe.mjs';
import { Guarded, launch } from './support/browser.mjs';
import { Bench } from './support/rtf.mjs';

const SCRIPT = '<script>alert(1)</script>';
const escaped = (text) => text.replaceAll('<', '&lt;').replaceAll('>', '&gt;');
const LUA = `TestCase = {}
function TestCase.run()
  local payload = tonumber(os.getenv('RTF_PARAM_PAYLOAD'))
  print('payload ' .. os.getenv('RTF_PARAM_PAYLOAD'))
  rtf.measure('sag', payload / 2, 'rad')
  rtf.check(payload < 1.5, 'too heavy for ${SCRIPT}')
end
`;
const BATCH = `import rtf


class Batch(rtf.EpisodeTest):
    def episode(self, episode):
        payload = float(episode.parameter("payload"))
        for _ in range(2):
            self.report(f"carries {episode.parameter('payload')}")
            yield 0.5
        self.measure("sag", payload / 2, "rad")
        return "too heavy" if payload >= 1.5 else None
`;
const CAMPAIGN = `<campaign name="${escaped(SCRIPT)}" suite="grasp.xml" episodes="60" seed="4">
  <parameter name="payload" distribution="uniform" low="0" high="2"/>
  <parameter name="friction" distribution="uniform" low="0" high="1"/>
  <parameter name="surface" distribution="choice" values="wood ${escaped(SCRIPT)}"/>
  <claim require="rate >= 0.9" confidence="0.95"/>
</campaign>
`;

let browser;
let bench;
let serve;
let shown;

before(async () => {
    browser = await launch();
    bench = await Bench.make();
    await bench.write('grasp.xml', '<suite name="grasp"><test>Grasp.lua</test></suite>');
    await bench.write('Grasp.lua', LUA);
    await bench.write('campaign.xml', CAMPAIGN);
    const program = bench.spawn(['campaign', 'run', 'campaign.xml', '-w', '2']);
    assert.equal(await program.ended, 1, program.printed);
    const json = bench.spawn('campaign show --format json --map payload,surface'.split(' '));
    assert.equal(await json.ended, 0, json.printed);
    shown = JSON.parse(json.printed);
    const html = bench.spawn('campaign show --format html --output campaign.html'.split(' '));
    assert.equal(await html.ended, 0, html.printed);
    serve = await bench.serve();
});
after(async () => {
    await browser.close();
    await bench.close();
});

const percent = (share) => `${(share * 100).toFixed(1)} %`;

/** The campaign on the server, by its link on the History page, and in the file. */
async function views(check, options) {
    const guarded = await Guarded.open(browser, `${serve.origin}/#/history/campaigns`, options);
    await guarded.page.getByRole('region', { name: 'Campaigns' }).getByRole('link').click();
    await guarded.see('Campaign', 'h1');
    await check(guarded, 'server');
    await guarded.close();
    const file = await Guarded.open(browser, bench.fileUrl('campaign.html'), options);
    await file.see('Campaign', 'h1');
    await check(file, 'file');
    await file.close();
}

test('the numbers are those of rtf campaign show', () =>
    views(async (guarded, where) => {
        const { page } = guarded;
        await guarded.see(SCRIPT, 'h1');
        await guarded.see('failed', 'h1');
        const { value, low, high } = shown.judgement.rate;
        await guarded.see(`${percent(value)} (${percent(low)} to ${percent(high)})`);
        await page.getByRole('img', { name: 'rate over episodes' }).waitFor();
        for (const { name, cells } of shown.parameters) {
            const table = page.getByRole('region', { name: `Rates by ${name}`, exact: true });
            const rows = await table.locator('tbody tr').allInnerTexts();
            assert.equal(rows.length, cells.length, `${where} ${name}`);
            cells.forEach(({ values, passed, episodes, rate }, index) => {
                assert.ok(rows[index].includes(values), rows[index]);
                assert.ok(rows[index].includes(`${passed} of ${episodes}`), rows[index]);
                assert.ok(rows[index].includes(percent(rate.low)), rows[index]);
            });
            const bars = await table.locator('.bar').evaluateAll((all) =>
                all.map((bar) => {
                    const part = (name) => bar.querySelector(name).getBoundingClientRect();
                    const { left, width } = bar.getBoundingClientRect();
                    const interval = part('.interval');
                    return [
                        part('.rate').width / width,
                        (interval.left - left) / width,
                        (interval.right - left) / width,
                    ];
                }),
            );
            cells.forEach(({ rate }, index) =>
                [rate.value, rate.low, rate.high].forEach((share, which) => {
                    const found = bars[index][which];
                    assert.ok(Math.abs(found - share) < 0.01, `${name} ${found} ${share}`);
                }),
            );
        }
        await page.getByText('Numbers').click();
        const progress = page.getByRole('region', { name: 'Progress' }).locator('tbody tr');
        assert.match(await progress.last().innerText(), /^60\s/);
    }));

test('the map has the chosen parameters, the same numbers, and turns', () =>
    views(async ({ page }) => {
        const map = page.getByRole('region', { name: 'Map', exact: true });
        const { columns, rows } = shown.map;
        await page.getByLabel('Columns').selectOption('payload');
        await page.getByLabel('Rows').selectOption('surface');
        const heads = (await map.locator('thead th').allInnerTexts()).map((text) => text.trim());
        assert.deepEqual(heads, columns);
        const wanted = [...rows]
            .reverse()
            .map(([values, cells]) => [
                values,
                ...cells.map(({ rate }) => (rate === null ? '–' : percent(rate.value))),
            ]);
        const cells = async () => {
            const found = [];
            for (const row of await map.locator('tbody tr').all())
                found.push((await row.locator('th, td').allInnerTexts()).map((it) => it.trim()));
            return found;
        };
        assert.deepEqual(await cells(), wanted);
        await page.getByLabel('Columns').selectOption('surface');
        await page.getByLabel('Rows').selectOption('payload');
        const turned = await cells();
        assert.equal(turned.length, columns.length);
        assert.deepEqual(
            turned.map((row) => row.at(-1)).reverse(),
            wanted[0].slice(1),
            'the last surface',
        );
    }));

test('failed episodes have their parameters and commands, which repeat them', () =>
    views(async (guarded, where) => {
        const list = guarded.page.getByRole('region', { name: 'Episodes that did not pass' });
        assert.equal(await list.locator('tbody tr').count(), shown.failed);
        const first = await list.locator('tbody tr').first().innerText();
        assert.ok(first.includes(`too heavy for ${SCRIPT}`), first);
        assert.ok(!first.includes('latest'), 'the command stays valid');
        assert.match(first, /payload=1\.[5-9]/);
        if (where === 'file') return;
        const command = await list.locator('code').first().innerText();
        const again = bench.spawn(command.trim().split(' ').slice(1));
        assert.equal(await again.ended, 1, again.printed);
    }));

test('a failed episode opens its run, at the test that failed', () =>
    views(async (guarded, where) => {
        const { page } = guarded;
        const list = page.getByRole('region', { name: 'Episodes that did not pass' });
        const row = list.locator('tbody tr').nth(1);
        const parameters = await row.innerText();
        const payload = /payload=([0-9.]+)/.exec(parameters)[1];
        if (where === 'file') {
            assert.equal(await row.getByRole('link').count(), 0);
            await guarded.see('rtf serve', 'section[aria-labelledby=problems]');
            return;
        }
        await row.getByRole('link').click();
        await guarded.see('too heavy for', '#detail .problem');
        assert.match(page.url(), /runs\/campaigns%2F.*%2Fworkers%2F[12]%2F.*\/tests\/0\?attempt=/);
        // It is the attempt of this episode: the test prints its payload.
        await guarded.see(`payload ${payload}`, '#detail');
        await page.getByRole('link', { name: 'its campaign' }).click();
        await guarded.see('Campaign', 'h1');
    }));

test('the worst episodes are next to the best ones, and open their runs', () =>
    views(async (guarded, where) => {
        const { page } = guarded;
        const rows = (name) => page.getByRole('region', { name, exact: true }).locator('tbody tr');
        await page.getByRole('combobox', { name: /^By\b/ }).selectOption('Grasp sag (rad)');
        const payloads = async (label) => {
            const texts = await rows(label).allInnerTexts();
            return texts.map((text) => Number(/payload=([0-9.]+)/.exec(text)[1]));
        };
        const [worst, best] = [await payloads('Worst episodes'), await payloads('Best episodes')];
        assert.equal(worst.length, 5, where);
        assert.ok(Math.min(...worst) >= 1.5, 'failed with the largest payloads');
        assert.deepEqual(
            worst,
            worst.toSorted((a, b) => b - a),
        );
        assert.deepEqual(
            best,
            best.toSorted((a, b) => a - b),
        );
        assert.ok(Math.max(...best) < worst.at(-1));
        if (where === 'file') {
            assert.equal(await rows('Best episodes').getByRole('link').count(), 0);
            return;
        }
        // A passed episode opens at the attempt of its test, too.
        await rows('Best episodes').first().getByRole('link').click();
        await guarded.see(`payload ${best[0]}`, '#detail');
        await guarded.see('sag', '#detail');
    }));

test('an episode of a batch opens its case, with only what was reported in it', async () => {
    await bench.write('batch.xml', '<suite name="batch"><test slots="4">Batch.py</test></suite>');
    await bench.write('Batch.py', BATCH);
    const batch = CAMPAIGN.replace('grasp.xml', 'batch.xml').replace(escaped(SCRIPT), 'batch');
    await bench.write('batch-campaign.xml', batch);
    const program = bench.spawn(['campaign', 'run', 'batch-campaign.xml', '--no-history']);
    assert.equal(await program.ended, 1, program.printed);
    const guarded = await Guarded.open(browser, `${serve.origin}/#/campaigns/latest`);
    const { page } = guarded;
    const list = page.getByRole('region', { name: 'Episodes that did not pass' });
    const failed = list.locator('tbody tr').first();
    await failed.waitFor();
    const cells = await failed.locator('td').allInnerTexts();
    const episode = cells[0].trim();
    const payload = /payload=([0-9.]+)/.exec(cells[3])[1];
    await failed.getByRole('link').click();
    await guarded.see(`episode ${episode}`, '#detail section h2');
    assert.match(page.url(), /\/tests\/0\?attempt=1&case=\d+$/);
    const facts = page.getByRole('region', { name: 'Case', exact: true });
    for (const text of ['failed', 'too heavy', `payload=${payload}`, '2 steps', 'simulated time'])
        await facts.getByText(text).first().waitFor();
    const reports = page.locator('#detail li', { hasText: 'carries' });
    await reports.first().waitFor();
    // Four episodes are open at a time, and each reports before and after a step.
    assert.equal(await reports.count(), 2);
    for (const text of await reports.allInnerTexts()) assert.ok(text.includes(payload), text);
    await guarded.see('sag', '#detail');
    assert.deepEqual(await violations(guarded), []);
    await page.getByRole('link', { name: 'Whole attempt' }).click();
    await guarded.see('Cases', '#detail h2');
    assert.ok((await reports.count()) > 2);
    await guarded.close();
});

test('axe finds nothing serious, in both themes', async () => {
    for (const colorScheme of ['light', 'dark'])
        await views(
            async (guarded, where) =>
                assert.deepEqual(await violations(guarded), [], `${colorScheme} ${where}`),
            { colorScheme },
        );
});

test('a running campaign is followed, and an unknown one is said so', async () => {
    await bench.write('slow.xml', '<suite name="slow"><test>Slow.lua</test></suite>');
    await bench.write('Slow.lua', 'TestCase = {}\nfunction TestCase.run() rtf.sleep(0.2) end\n');
    const slow = CAMPAIGN.replace('grasp.xml', 'slow.xml').replace(escaped(SCRIPT), 'slow');
    await bench.write('slow-campaign.xml', slow.replace('"60"', '"30"').replace('0.9', '0.95'));
    const running = bench.spawn(['campaign', 'run', 'slow-campaign.xml', '--no-history']);
    // It prints its name when its directory exists.
    while (!running.printed.includes('campaign slow')) await setTimeout(20);
    const guarded = await Guarded.open(browser, `${serve.origin}/#/campaigns/latest`);
    await guarded.see('running', 'h1');
    await running.ended;
    await guarded.see('30 passed');
    await guarded.page.locator('h1', { hasText: 'running' }).waitFor({ state: 'detached' });
    // All of 30 passed: the interval of 30 contains 0.95.
    await guarded.see(/Undecided: a decision needs about \d+ more episodes/);
    await guarded.page.evaluate(() => (location.hash = '#/campaigns/..%2F..'));
    await guarded.see('there is no such campaign', '[role=alert]');
    await guarded.close();
});

test('the file has no place for markup of its data', async () => {
    const text = await readFile(path.join(bench.dir, 'campaign.html'), 'utf8');
    assert.ok(!text.includes('alert(1)'));
});
