// The packaged extension in VS Code's server, driven by a real Chromium: tests are found, one is
// run and passes; broken, it fails with its message.

import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { mkdir, mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const PACKAGE = fileURLToPath(new URL('../dist/rtf.vsix', import.meta.url));
const PROGRAMS = [process.env['CHROMIUM'], '/usr/bin/chromium', '/usr/bin/chromium-browser'];
// The editor takes a few seconds to start on an idle machine, and minutes on a busy one.
const PATIENCE_MS = 120_000;

const SUITE = `<?xml version="1.0" encoding="UTF-8"?>
<suite name="arm">
  <test name="Reach">Reach.lua</test>
  <test name="Grip">Grip.lua</test>
</suite>
`;
const PASSES = `TestCase = {}
function TestCase.run()
  print('reaching')
end
`;
const FAILS = PASSES.replace("print('reaching')", "rtf.fail('stuck at joint 3')");

const SETTINGS = {
    'chat.disableAIFeatures': true,
    'extensions.autoCheckUpdates': false,
    'git.enabled': false,
    'rtf.path': process.env['RTF'],
    'telemetry.telemetryLevel': 'off',
    // A tooltip would cover the rows below.
    'workbench.hover.delay': 600_000,
    'workbench.startupEditor': 'none',
};

let dir;
let workspace;
let server;
let browser;
let page;

/** The options of both uses of the server. */
function options() {
    const main = join(process.env['VSCODE_SERVER'] ?? '', 'out/server-main.js');
    return [
        main,
        '--accept-server-license-terms',
        '--server-data-dir',
        join(dir, 'server'),
        '--user-data-dir',
        join(dir, 'user'),
        '--extensions-dir',
        join(dir, 'extensions'),
    ];
}

/** Starts the server, and returns its port. */
async function startServer() {
    const args = ['--host', '127.0.0.1', '--port', '0', '--without-connection-token'];
    server = spawn(
        process.execPath,
        [...options(), ...args, '--telemetry-level', 'off', '--disable-workspace-trust'],
        // Without a registry of extensions, the server asks no other machine.
        { env: { ...process.env, EXTENSIONS_GALLERY: '{}' }, detached: true },
    );
    let output = '';
    server.stderr.on('data', (piece) => (output += piece));
    return await new Promise((resolve, reject) => {
        server.stdout.on('data', (piece) => {
            output += piece;
            const bound = /Server bound to 127\.0\.0\.1:(\d+)/.exec(output);
            if (bound !== null) resolve(bound[1]);
        });
        server.on('exit', () => reject(new Error(`the server has ended:\n${output}`)));
    });
}

before(async () => {
    dir = await mkdtemp(join(tmpdir(), 'rtf-vscode-'));
    workspace = join(dir, 'workspace');
    await mkdir(workspace);
    await mkdir(join(dir, 'user/User'), { recursive: true });
    await mkdir(join(dir, 'user/Machine'), { recursive: true });
    for (const [name, text] of [
        ['workspace/arm.xml', SUITE],
        ['workspace/robot.xml', '<robot name="arm"/>\n'],
        ['workspace/Reach.lua', PASSES],
        ['workspace/Grip.lua', PASSES],
        ['user/User/settings.json', JSON.stringify(SETTINGS)],
        ['user/Machine/settings.json', JSON.stringify(SETTINGS)],
    ]) {
        await writeFile(join(dir, name), text);
    }
    execFileSync(process.execPath, [...options(), '--install-extension', PACKAGE], {
        stdio: 'pipe',
    });
    const port = await startServer();
    const executablePath = PROGRAMS.find((each) => each !== undefined && existsSync(each));
    assert.ok(executablePath, 'Chromium is not installed: tools/bootstrap.sh test');
    const rules = '--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1';
    const args = ['--no-sandbox', '--disable-dev-shm-usage', rules];
    browser = await chromium.launch({ executablePath, args });
    page = await browser.newPage({ viewport: { width: 1280, height: 860 } });
    page.setDefaultTimeout(PATIENCE_MS);
    await page.goto(`http://127.0.0.1:${port}/?folder=${workspace}`, { timeout: PATIENCE_MS });
});

after(async () => {
    await browser?.close();
    // The server ignores SIGTERM while it waits for a browser to reconnect.
    if (server?.exitCode === null) process.kill(-server.pid, 'SIGKILL');
    await rm(dir, { recursive: true, force: true, maxRetries: 5 });
});

/** A row of the Test Explorer, whose label contains its state: `Reach (Passed)`. */
function row(label) {
    return page.locator(`.test-explorer [role=treeitem][aria-label*="${label}"]`);
}

/** Waits for a row; the error has all rows and a picture. */
async function see(label) {
    await row(label)
        .first()
        .waitFor()
        .catch(async (late) => {
            const rows = await page
                .locator('.test-explorer [role=treeitem]')
                .evaluateAll((all) => all.map((each) => each.getAttribute('aria-label')));
            const picture = process.env['PICTURE'];
            if (picture !== undefined) await page.screenshot({ path: picture });
            throw new Error(`not seen: ${label}\nseen: ${rows.join('\n')}`, { cause: late });
        });
}

async function run(name, action = 'Run Test') {
    await row(name).first().hover();
    await row(name).first().getByRole('button', { name: action }).click();
}

test('the Test Explorer runs tests, and shows their results', async (context) => {
    // Later steps need the earlier ones.
    const step = async (name, body) => {
        let failure;
        await context.test(name, async () => {
            await body().catch((error) => {
                failure = error;
                throw error;
            });
        });
        if (failure !== undefined) throw failure;
    };
    await step('suites and their tests are shown, other XML files are not', async () => {
        await page.getByRole('tab', { name: 'Testing' }).click();
        await see('arm');
        await row('arm').first().click();
        await page.keyboard.press('ArrowRight');
        await see('Reach');
        await see('Grip');
        assert.equal(await row('robot').count(), 0);
    });
    await step('a test passes', async () => {
        await run('Reach');
        await see('Reach (Passed');
        await see('Grip (Not yet run');
    });
    await step('broken, it fails with its message', async () => {
        await writeFile(join(workspace, 'Reach.lua'), FAILS);
        await run('Reach');
        await see('Reach (Failed');
        await page.getByText('stuck at joint 3').first().waitFor();
    });
    await step('repaired, the suite passes', async () => {
        await writeFile(join(workspace, 'Reach.lua'), PASSES);
        await run('arm');
        await see('Reach (Passed');
        await see('Grip (Passed');
    });
    await step('debugged without a debugger, the test runs and says why', async () => {
        await writeFile(join(workspace, 'Reach.lua'), FAILS);
        await run('Reach', 'Debug Test');
        await see('Reach (Failed');
        await page.getByText('no debugger can attach to tests of type lua').first().waitFor();
    });
});
