// Questions of tests are answered on the page with the token, by programs, and disappear with
// their tests.

import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { violations } from './support/axe.mjs';
import { Guarded, launch } from './support/browser.mjs';
import { Bench, within } from './support/rtf.mjs';

const test_of = (kind) =>
    `<test type="python" name="${kind}" param="${kind}" timeout="5s">Asks</test>`;
const ASKING = `<suite name="asking" parallel="3">
  ${test_of('choice')}${test_of('text')}${test_of('instruction')}
</suite>`;

let browser;
let bench;
let run;

before(async () => {
    browser = await launch();
});
after(() => browser.close());
beforeEach(async () => {
    bench = await Bench.make();
    run = await bench.run(ASKING);
});
afterEach(() => bench.close());

const form = ({ page }, name) => page.getByRole('form', { name: `Question of ${name}` });

test('choices, texts and instructions are answered, and then shown with their answers', async () => {
    const guarded = await Guarded.open(browser, run.url);
    const choice = form(guarded, 'choice');
    await choice.getByText('<b>hand</b>').waitFor();
    const picture = choice.getByRole('img');
    const isLoaded = () => picture.evaluate((image) => image.complete && image.naturalWidth > 0);
    while (!(await isLoaded())) await guarded.page.waitForTimeout(20);
    await choice.getByRole('button', { name: 'yes' }).click();
    await choice.waitFor({ state: 'detached' });
    const text = form(guarded, 'text');
    await text.getByLabel('Answer').fill('SN-17 größe');
    await text.getByLabel('Answer').press('Enter');
    await text.waitFor({ state: 'detached' });
    await form(guarded, 'instruction').getByRole('button', { name: 'done' }).click();
    for (const name of ['choice', 'text', 'instruction']) await guarded.rowIs(name, 'passed');
    assert.equal(await within('the end of the run', run.ended), 0);
    await guarded.close();
    // A past run, and a report without a server.
    const serve = await bench.serve();
    const [name] = await bench.names();
    const report = await bench.report(name);
    for (const address of [
        `${serve.url.split('#')[0]}#/runs/${name}/tests/0`,
        `${report}#/runs/${name}/tests/0`,
    ]) {
        const past = await Guarded.open(browser, address);
        await past.see('yes (127.0.0.1, on the page)');
        await past.see('it is yes');
        assert.equal(await form(past, 'choice').count(), 0);
        assert.ok(
            (await past.page.getByRole('link', { name: 'picture' }).getAttribute('href')).length >
                0,
        );
        await past.close();
    }
});

test('without the token a question is read, and not answered', async () => {
    const guarded = await Guarded.open(browser, run.origin);
    await form(guarded, 'choice').getByText('Answers: yes, no').waitFor();
    assert.equal(await guarded.page.getByRole('button', { name: 'yes' }).count(), 0);
    await guarded.close();
});

test('a program answers, and the page follows', async () => {
    const guarded = await Guarded.open(browser, run.url);
    await form(guarded, 'text').waitFor();
    const headers = { Authorization: `Bearer ${run.token}`, 'Content-Type': 'application/json' };
    const api = `${run.origin}/api/v1/runs/current/tests/1`;
    const found = await (await fetch(api, { headers })).json();
    const { question } = found.test.questions[0].question;
    const body = JSON.stringify({ answer: 'SN-18' });
    const post = () =>
        fetch(`${api}/questions/${question}/answer`, { method: 'POST', headers, body });
    assert.equal((await post()).status, 202);
    await form(guarded, 'text').waitFor({ state: 'detached' });
    assert.equal((await post()).status, 409);
    await guarded.row('text').click();
    await guarded.see('SN-18 (127.0.0.1, over the API)');
    await guarded.close();
});

test('a stopped test takes its question along', async () => {
    const guarded = await Guarded.open(browser, run.url);
    await form(guarded, 'choice').waitFor();
    await guarded.row('choice').click();
    await guarded.button('Stop the test').click();
    await guarded.button('Yes, stop the test').click();
    await form(guarded, 'choice').waitFor({ state: 'detached' });
    await guarded.rowIs('choice', 'interrupted');
    await guarded.see('not answered: stopped by a person, in the browser');
    await form(guarded, 'text').waitFor();
    await guarded.close();
});

for (const colorScheme of ['light', 'dark']) {
    test(`on a phone, questions come first and axe finds nothing: ${colorScheme}`, async () => {
        const viewport = { width: 390, height: 844 };
        const options = { viewport, colorScheme, hasTouch: true };
        const guarded = await Guarded.open(browser, run.url, options);
        await form(guarded, 'instruction').waitFor();
        assert.deepEqual(await violations(guarded), []);
        const width = await guarded.page.evaluate(
            () => document.getElementById('main').scrollWidth,
        );
        assert.ok(width <= 390, `${width} px`);
        const yes = form(guarded, 'choice').getByRole('button', { name: 'yes' });
        const { height } = await yes.boundingBox();
        assert.ok(height >= 40, `${height} px`);
        await yes.tap();
        await form(guarded, 'choice').waitFor({ state: 'detached' });
        await guarded.close();
    });
}
