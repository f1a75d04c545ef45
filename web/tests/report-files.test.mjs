// A report in one HTML file: large attachments next to it, the policies under which it is
// shown, and the time until a large one is drawn.

import assert from 'node:assert/strict';
import { mkdir, readdir, readFile, writeFile } from 'node:fs/promises';
import http from 'node:http';
import path from 'node:path';
import { after, before, test } from 'node:test';
import zlib from 'node:zlib';
import { Guarded, launch } from './support/browser.mjs';
import { Bench, step } from './support/rtf.mjs';
import { manyTests, oneTest } from './support/journals.mjs';

/** How long a report of 3000 tests may take on a busy machine; without load, 2 s. */
const OPEN_MS = 10_000;

let browser;
let bench;

before(async () => {
    browser = await launch();
    bench = await Bench.make();
});
after(async () => {
    await browser.close();
    await bench.close();
});

/** A picture with this number of pixels in a row and a column, not compressed. */
function png(size) {
    const rows = Buffer.alloc(size * (3 * size + 1), 120);
    for (let row = 0; row < size; row += 1) rows[row * (3 * size + 1)] = 0;
    const header = Buffer.alloc(13);
    header.writeUInt32BE(size, 0);
    header.writeUInt32BE(size, 4);
    header.set([8, 2, 0, 0, 0], 8);
    const chunk = (kind, data) => {
        const body = Buffer.concat([Buffer.from(kind), data]);
        const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
        length.writeUInt32BE(data.length);
        check.writeUInt32BE(zlib.crc32 ? zlib.crc32(body) : crc32(body));
        return Buffer.concat([length, body, check]);
    };
    return Buffer.concat([
        Buffer.from('\x89PNG\r\n\x1a\n', 'latin1'),
        chunk('IHDR', header),
        chunk('IDAT', zlib.deflateSync(rows, { level: 0 })),
        chunk('IEND', Buffer.alloc(0)),
    ]);
}

/** For versions of Node without `zlib.crc32`. */
function crc32(bytes) {
    let crc = ~0;
    for (const byte of bytes) {
        crc ^= byte;
        for (let bit = 0; bit < 8; bit += 1) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
    }
    return ~crc >>> 0;
}

/** A run whose test attached these files; files without content are missing. */
async function attached(run, files) {
    const attachments = Object.keys(files).map((name) => ({
        type: 'attached',
        test: 0,
        attachment: { name: path.basename(name), path: name, media_type: '' },
    }));
    await bench.journal(run, oneTest(run, attachments));
    const dir = path.join(bench.dir, 'rtf-results', run);
    await mkdir(path.join(dir, 'attachments'));
    for (const [name, content] of Object.entries(files))
        if (content !== null) await writeFile(path.join(dir, name), content);
    return dir;
}

test('small attachments are in the report, large ones next to it', async () => {
    await writeFile(path.join(bench.dir, 'secret.txt'), 'secret');
    const run = '2026-11-21T06-30-12Z-0001';
    await attached(run, {
        'attachments/small.png': png(20),
        'attachments/large #1.png': png(600),
        'attachments/log.txt': 'text',
        'attachments/missing.txt': null,
        '../../secret.txt': null,
    });
    const large = async (url, src, ...requested) => {
        const guarded = await Guarded.open(browser, `${url}#/runs/${run}/tests/0`);
        for (const [name, width] of [
            ['small.png', 20],
            ['large #1.png', 600],
        ]) {
            const image = guarded.page.getByRole('img', { name });
            await image.scrollIntoViewIfNeeded();
            await image.evaluate((each) => each.decode());
            assert.equal(await image.evaluate((each) => each.naturalWidth), width);
        }
        const image = guarded.page.getByRole('img', { name: 'large #1.png' });
        assert.equal(await image.getAttribute('src'), src);
        const link = guarded.page.getByRole('link', { name: 'log.txt' });
        assert.equal(
            await link.getAttribute('href'),
            'data:text/plain; charset=utf-8;base64,dGV4dA==',
        );
        for (const name of ['missing.txt', 'secret.txt']) {
            await guarded.see(name, '#detail');
            assert.equal(await guarded.page.getByRole('link', { name }).count(), 0);
        }
        const files = guarded.requests.map((each) => new URL(each.url()));
        const others = files.filter(({ protocol }) => protocol !== 'data:').slice(1);
        assert.deepEqual(
            others.map(({ pathname }) => decodeURIComponent(pathname.split('/').at(-1))),
            requested,
        );
        await guarded.close();
    };
    await step('next to the report', async () => {
        const url = await bench.report(run, 'out/report.html');
        await large(url, 'report_files/large%20%231.png', 'large #1.png');
        assert.deepEqual(await readdir(path.join(bench.dir, 'out/report_files')), ['large #1.png']);
    });
    await step('in the run directory', async () => {
        const url = await bench.report(run, `rtf-results/${run}/report.html`);
        await large(url, 'attachments/large%20%231.png', 'large #1.png');
    });
    await step('on standard output', async () => {
        const program = bench.spawn(['report', run, '--format', 'html']);
        assert.equal(await program.ended, 0);
        await writeFile(path.join(bench.dir, 'piped.html'), program.printed);
        const url = bench.fileUrl('piped.html');
        const guarded = await Guarded.open(browser, `${url}#/runs/${run}/tests/0`);
        await guarded.see('not in this report, only in the run directory', '#detail');
        assert.equal(await guarded.page.getByRole('img', { name: 'small.png' }).count(), 1);
        assert.equal(await guarded.page.getByRole('img', { name: 'large #1.png' }).count(), 0);
        await guarded.close();
    });
});

/** A report that has been changed. */
async function changed(change, file) {
    const run = '2026-11-21T06-30-12Z-0002';
    await bench.journal(run, oneTest(run, []));
    const html = await readFile(new URL(await bench.report(run)), 'utf8');
    await writeFile(path.join(bench.dir, file), change(html));
    return bench.fileUrl(file);
}

test('the policy blocks every other script, style and request', async () => {
    const injected = `<script>globalThis.injected = 'script'</script>
        <img src="missing.png" onerror="globalThis.injected = 'handler'">
        <style>#app { display: none }</style>
        <script src="https://example.com/x.js"></script><body `;
    const url = await changed((html) => html.replace('<body', injected), 'injected.html');
    const context = await browser.newContext();
    const page = await context.newPage();
    const blocked = [];
    page.on('console', (message) => blocked.push(message.text()));
    await page.goto(url);
    await page.locator('section.summary').waitFor();
    const attempts = await page.evaluate(async () => {
        const script = document.createElement('script');
        script.textContent = `globalThis.injected = 'element'`;
        document.body.append(script);
        const refused = await fetch('data:text/plain,x').catch(() => 'refused');
        return [globalThis.injected, refused];
    });
    assert.deepEqual(attempts, [undefined, 'refused']);
    const policy = blocked.filter((text) => /Content Security Policy/.test(text));
    assert.ok(policy.length >= 5, blocked.join('\n'));
    await context.close();
});

test('a damaged report says so', async () => {
    const damage = (html) => html.replace(/(id="rtf-overview">.{20})..../, '$1AAAA');
    const url = await changed(damage, 'damaged.html');
    const guarded = await Guarded.open(browser, url);
    await guarded.see(/This report cannot be read, the file may be damaged/);
    await guarded.close();
});

/** Serves a file with a policy, as a CI server does with artefacts. */
async function serve(file, policy) {
    const content = await readFile(path.join(bench.dir, file));
    const server = http.createServer((request, response) => {
        response.setHeader('Content-Security-Policy', policy);
        response.setHeader('Content-Type', 'text/html; charset=utf-8');
        response.end(content);
    });
    await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
    return { server, url: `http://127.0.0.1:${server.address().port}/${file}` };
}

test('an artefact of a CI job is shown as far as its server permits', async (context) => {
    await changed((html) => html, 'artefact.html');
    const open = async (policy) => {
        const { server, url } = await serve('artefact.html', policy);
        context.after(() => server.close());
        const page = await browser.newPage();
        await page.goto(url);
        return page;
    };
    await step('in a sandbox with scripts', async () => {
        const page = await open(
            "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; " +
                "style-src 'unsafe-inline'; img-src data:",
        );
        await page.getByRole('treeitem').filter({ hasText: 'Only' }).click();
        await page.getByText('a message').waitFor();
        await page.close();
    });
    await step('without scripts, as in Jenkins', async () => {
        const page = await open("sandbox; default-src 'none'; img-src 'self'; style-src 'self'");
        await page.getByText(/the script of the report is blocked/).waitFor();
        await page.close();
    });
});

test('3000 tests with signals', async () => {
    const run = '2026-11-21T06-30-12Z-3000';
    await bench.journal(run, manyTests(run, 3000));
    const url = await bench.report(run, 'many.html');
    const { length } = await readFile(new URL(url));
    const guarded = await Guarded.open(browser, 'about:blank');
    const { page } = guarded;
    guarded.mistakes.length = 0;
    const started = performance.now();
    await page.goto(url, { waitUntil: 'commit' });
    await page.getByRole('treeitem').filter({ hasText: 'Test0000' }).waitFor();
    const drawn = performance.now();
    await page.evaluate((to) => (location.hash = to), `#/runs/${run}/tests/2999`);
    await page.locator('#detail .uplot canvas').nth(1).waitFor();
    const plotted = performance.now();
    const [open, test] = [drawn - started, plotted - drawn].map(Math.round);
    console.log(
        `3000 tests, ${(length / 1e6).toFixed(1)} MB: drawn after ${open} ms, ` +
            `the signals of a test after ${test} ms more`,
    );
    assert.ok(open < OPEN_MS, `${open} ms`);
    assert.ok(test < OPEN_MS, `${test} ms`);
    await guarded.context.close();
});
