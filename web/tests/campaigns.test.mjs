// Rates of campaigns over commits, on the History page.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { violations } from './support/axe.mjs';
import { Guarded, launch } from './support/browser.mjs';
import { Bench } from './support/rtf.mjs';

const SCRIPT = '<script>alert(1)</script>';
const escaped = (text) => text.replaceAll('<', '&lt;').replaceAll('>', '&gt;');

/** Passes if the payload is below a limit. */
const lua = (limit) => `TestCase = {}
function TestCase.run()
  rtf.check(tonumber(os.getenv('RTF_PARAM_PAYLOAD')) < ${limit}, 'too heavy')
end
`;
const SUITE = '<suite name="grasp"><test>Grasp.lua</test></suite>';
const campaign = (
    name,
) => `<campaign name="${escaped(name)}" suite="grasp.xml" episodes="40" seed="4">
  <parameter name="payload" distribution="uniform" low="0" high="2"/>
  <claim require="rate >= 0.5" confidence="0.95"/>
</campaign>
`;

let browser;
let bench;
let serve;

before(async () => {
    browser = await launch();
    bench = await Bench.make();
    await bench.write('grasp.xml', SUITE);
    await bench.write('grasp-campaign.xml', campaign('grasp'));
    await bench.write('script-campaign.xml', campaign(SCRIPT));
    for (const limit of [1.95, 1.95, 0.9]) {
        await bench.write('Grasp.lua', lua(limit));
        await bench.spawn(['campaign', 'run', 'grasp-campaign.xml']).ended;
    }
    await bench.spawn(['campaign', 'run', 'script-campaign.xml']).ended;
    serve = await bench.serve();
});
after(async () => {
    await browser.close();
    await bench.close();
});

const open = (hash, options) => Guarded.open(browser, `${serve.origin}/${hash}`, options);

test('rates have intervals, claims and the change, and a table', async () => {
    const guarded = await open('#/history');
    const { page } = guarded;
    await page.getByRole('link', { name: 'Campaigns' }).click();
    assert.match(page.url(), /#\/history\/campaigns$/);
    const section = page
        .locator('section', { has: page.locator('h2', { hasText: 'grasp' }) })
        .last();
    const plot = section.getByRole('img', { name: 'rate over campaigns' });
    await plot.waitFor();
    assert.equal(await plot.locator('circle').count(), 3);
    assert.equal(await plot.locator('line.interval').count(), 3);
    assert.equal(await plot.locator('line.claim').count(), 3);
    assert.equal(await plot.locator('line.change').count(), 1);
    const changes = section.getByRole('list', { name: 'Changes' });
    assert.match(await changes.innerText(), /97\.5 % → 37\.5 % \(-60 %\), p < 0\.0001/);
    const rows = section.getByRole('region', { name: 'Campaigns' }).getByRole('row');
    assert.equal(await rows.count(), 4, 'three campaigns and a head');
    const newest = await rows.nth(1).innerText();
    assert.match(newest, /undecided\s+37\.5 % \(24\.2 % to 53\.0 %\)\s+≥ 50 %\s+15 of 40\s+0/);
    await guarded.close();
});

test('a selection without campaigns is said so, and names are text', async () => {
    const guarded = await open('#/history/campaigns?host=none');
    await guarded.see('No campaign has run.');
    await guarded.page.evaluate(() => (location.hash = '#/history/campaigns'));
    await guarded.see(SCRIPT, 'h2');
    await guarded.close();
});

test('a campaign without a result has no mark', async () => {
    await bench.write(
        'grasp.xml',
        '<suite name="grasp"><fixture name="sim" type="process"><command>false</command>' +
            '<ready log="never"/></fixture><test>Grasp.lua</test></suite>',
    );
    await bench.spawn(['campaign', 'run', 'grasp-campaign.xml']).ended;
    await bench.write('grasp.xml', SUITE);
    const guarded = await open('#/history/campaigns?last=1');
    await guarded.see('no result');
    assert.equal(await guarded.page.locator('circle').count(), 0);
    await guarded.close();
});

test('axe finds nothing serious, in both themes', async () => {
    for (const colorScheme of ['light', 'dark']) {
        const guarded = await open('#/history/campaigns', { colorScheme });
        await guarded.see('Changed on');
        assert.deepEqual(await violations(guarded), [], colorScheme);
        await guarded.close();
    }
});
