// Cases, known failures and matrix parameters on the page.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Guarded, launch } from './support/browser.mjs';
import { Bench } from './support/rtf.mjs';

const NAME = '2026-11-21T06-30-12Z-0001';
const SCRIPT = '<img src=x onerror=alert(1)>';
const HOSTILE_ISSUE = 'javascript:alert(document.domain)';

const planned = (test, name, more = {}) => ({
    ...{ type: 'test-planned', test, suite: 0, name, plugin_type: 'python' },
    ...{ plugin: '/arm/move.py', repetitions: 1, ...more },
});
const started = (test) => ({ type: 'test-started', test, repetition: 1, attempt: 1 });
const finished = (test, verdict, reason) => ({
    ...{ type: 'test-finished', test, verdict, phase: 'run' },
    ...(reason === undefined ? {} : { reason }),
});
const begin = (id, name, more = {}) => ({
    ...{ type: 'case-started', test: 0, case: id, name, ...more },
});
const end = (id, verdict, reason) => ({
    ...{ type: 'case-finished', test: 0, case: id, verdict },
    ...(reason === undefined ? {} : { reason }),
});
const said = (text, id) => ({
    ...{ type: 'message', source: { test: 0 } },
    message: { kind: 'report', text, ...(id === undefined ? {} : { case: id }) },
});

const EVENTS = [
    {
        ...{ type: 'run-started', version: 1, run: NAME, rtf: '0.1.0' },
        started_at: '2026-11-21T07:30:12+01:00',
        ...{ command: ['rtf', 'run', 'arm.xml'], working_dir: '/arm', suites: 1, tests: 4 },
    },
    {
        ...{ type: 'suite-planned', suite: 0, name: 'arm', file: 'arm.xml' },
        ...{ description: '', environment: '' },
    },
    planned(0, 'Move[joint=3]', { parameters: [{ name: 'joint', value: '3' }] }),
    planned(1, 'Grip', {
        expected: { verdicts: ['failed'], issue: 'https://example.org/issues/7', reason: SCRIPT },
    }),
    planned(2, 'Look', {
        expected: { verdicts: ['failed'], issue: HOSTILE_ISSUE, quarantined: true },
    }),
    planned(3, 'Stand', { expected: { verdicts: ['failed'], until: '2027-01-31' } }),
    { type: 'suite-started', suite: 0 },
    started(0),
    { type: 'cases-planned', test: 0, names: ['Elbow', 'Wrist', 'Hand'] },
    begin(1, 'Elbow', { location: { file: 'move.py', line: 17 } }),
    begin(2, 'bends', { parent: 1, parameters: [{ name: 'angle', value: '90' }] }),
    said('bent to 90 degrees', 2),
    end(2, 'passed'),
    begin(3, SCRIPT, { parent: 1 }),
    said('blocked by a cable', 3),
    end(3, 'failed', 'the elbow stops at 40 degrees'),
    end(1, 'failed', 'a case failed'),
    begin(4, 'Wrist'),
    said('no wrist is mounted', 4),
    end(4, 'skipped', 'no wrist'),
    said('all done'),
    finished(0, 'failed', 'the elbow stops at 40 degrees'),
    started(1),
    finished(1, 'failed', 'it is loose'),
    started(2),
    finished(2, 'failed', 'it is dark'),
    started(3),
    finished(3, 'passed'),
    { type: 'suite-finished', suite: 0 },
    { type: 'run-finished' },
];

let browser;
let bench;
let guarded;

before(async () => {
    browser = await launch();
    bench = await Bench.make();
    await bench.journal(NAME, EVENTS);
    const serve = await bench.serve();
    guarded = await Guarded.open(browser, serve.url);
    await guarded.run(NAME).click();
    await guarded.row('Move').click();
});
after(async () => {
    await guarded.close();
    await browser.close();
    await bench.close();
});

const cases = () => guarded.page.getByRole('list', { name: 'Cases', exact: true });
const caseButton = (name) => cases().getByRole('button', { name, exact: true });
const item = (name) => cases().getByRole('listitem').filter({ hasText: name });

test('a test shows its cases as a tree', async () => {
    await item('bends').waitFor();
    const rows = await cases().getByRole('listitem').allInnerTexts();
    const names = rows.map((row) => row.replace(/\s+/g, ' ').trim());
    assert.equal(names.length, 4);
    assert.match(names[0], /^failed: Elbow move\.py:17 .*a case failed$/);
    assert.match(names[1], /^passed: bends angle=90 2(\.\d+)? ms$/);
    assert.ok(names[2].startsWith(`failed: ${SCRIPT} `), names[2]);
    assert.match(names[2], /the elbow stops at 40 degrees$/);
    assert.match(names[3], /^skipped: Wrist .*no wrist$/);
    const left = async (name) => (await caseButton(name).boundingBox()).x;
    assert.ok((await left('bends')) > (await left('Elbow')), 'a nested case is indented');
    await guarded.see('Did not run (1)', '#detail');
    await guarded.see('Hand', '#detail');
});

test('the selected case selects the messages', async () => {
    await guarded.see('all done', '#detail');
    // Without a selection, each message shows its case.
    await guarded.see('Elbow/bends', '#detail');
    await caseButton('Elbow').click();
    await guarded.gone('all done', '#detail');
    await guarded.gone('no wrist is mounted', '#detail');
    await guarded.see('bent to 90 degrees', '#detail');
    await guarded.see('blocked by a cable', '#detail');
    await guarded.button('Show all messages').click();
    await guarded.see('all done', '#detail');
});

test('cases are filtered by verdict', async () => {
    const group = guarded.page.getByRole('group', { name: 'Shown verdicts of cases' });
    await group.getByRole('button', { name: '1 passed' }).click();
    await item('Wrist').waitFor({ state: 'detached' });
    assert.equal(await cases().getByRole('listitem').count(), 2, 'the case and its parent');
    await group.getByRole('button', { name: '1 passed' }).click();
    await item('Wrist').waitFor();
});

test('a test is found by a case and by a parameter', async () => {
    const search = guarded.page.getByLabel('Search tests');
    await search.fill('elbow bends');
    await guarded.see('1 of 4', '.search');
    await guarded.row('Move').waitFor();
    await search.fill('joint=3');
    await guarded.see('1 of 4', '.search');
    await search.fill('no such case');
    await guarded.see('No test matches.');
    await search.fill('');
});

test('known failures are labelled and can be filtered', async () => {
    await guarded.see('expected', '[role=tree]');
    await guarded.see('quarantined', '[role=tree]');
    await guarded.see('unexpected pass', '[role=tree]');
    const filters = guarded.page.getByRole('group', { name: 'Filter tests by state' });
    await filters.getByRole('button', { name: /quarantined$/ }).click();
    await guarded.row('Grip').waitFor({ state: 'detached' });
    await guarded.row('Look').waitFor();
    await filters.getByRole('button', { name: 'show all' }).click();
    await filters.getByRole('button', { name: /expected$/ }).click();
    await guarded.row('Look').waitFor({ state: 'detached' });
    await guarded.row('Grip').waitFor();
    await guarded.row('Stand').waitFor();
    await filters.getByRole('button', { name: 'show all' }).click();
});

test('only an http address of an issue is a link', async () => {
    const { page } = guarded;
    await guarded.row('Grip').click();
    const link = page.getByRole('link', { name: 'https://example.org/issues/7' });
    assert.equal(await link.getAttribute('href'), 'https://example.org/issues/7');
    assert.equal(await link.getAttribute('rel'), 'noopener noreferrer');
    await guarded.see(SCRIPT, '.known');
    await guarded.row('Look').click();
    await guarded.see(HOSTILE_ISSUE, '.known');
    assert.equal(await page.locator('.known a').count(), 0);
    await guarded.row('Stand').click();
    await guarded.see('remove the mark', '.known');
    assert.equal(await page.locator('main img').count(), 0);
});
