// A real Chromium with guarded pages: a test fails if its page logs
// an error, sends a request to another origin, or violates its policy.

import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { chromium } from 'playwright-core';

const PROGRAMS = [process.env['CHROMIUM'], '/usr/bin/chromium', '/usr/bin/chromium-browser'];
const PATIENCE_MS = 20_000;

export function launch() {
    const executablePath = PROGRAMS.find((each) => each !== undefined && existsSync(each));
    assert.ok(executablePath, 'Chromium is not installed: tools/bootstrap.sh test');
    return chromium.launch({
        executablePath,
        args: [
            '--no-sandbox',
            '--disable-dev-shm-usage',
            '--disable-background-networking',
            '--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1',
        ],
    });
}

/** A page and its mistakes, of which there must be none at the end. */
export class Guarded {
    mistakes = [];
    requests = [];

    static async open(browser, url, options = {}) {
        const guarded = new Guarded();
        guarded.context = await browser.newContext({
            viewport: { width: 1280, height: 860 },
            ...options,
        });
        guarded.page = await guarded.context.newPage();
        guarded.page.setDefaultTimeout(PATIENCE_MS);
        guarded.watch(new URL(url).origin);
        await guarded.page.goto(url);
        return guarded;
    }

    watch(origin) {
        const { page } = this;
        page.on('console', (message) => {
            // The browser, not the page, logs failed requests.
            const isNetwork = /^Failed to load resource/.test(message.text());
            if (message.type() === 'error' && !isNetwork) this.mistakes.push(message.text());
        });
        page.on('pageerror', (error) => this.mistakes.push(error.message));
        page.on('dialog', (dialog) => {
            this.mistakes.push(`a dialog: ${dialog.message()}`);
            void dialog.dismiss();
        });
        page.on('request', (request) => {
            this.requests.push(request);
            const { protocol, origin: from } = new URL(request.url());
            // What is in the page is requested from nowhere.
            if (from !== origin && protocol !== 'data:') {
                this.mistakes.push(`a request to ${request.url()}`);
            }
        });
    }

    /** Waits until an element with this text is visible. */
    async see(text, within = 'body') {
        const found = this.page.locator(within).getByText(text).filter({ visible: true }).first();
        await found.waitFor().catch(async (late) => {
            const shown = await this.page
                .locator(within)
                .first()
                .innerText()
                .catch(() => '');
            throw new Error(`not seen: ${text}\n--- what is seen in ${within}:\n${shown}`, {
                cause: late,
            });
        });
        return found;
    }

    /** Waits until no element with this text is visible. */
    async gone(text, within = 'body') {
        await this.page
            .locator(within)
            .getByText(text)
            .filter({ visible: true })
            .first()
            .waitFor({ state: 'hidden' });
    }

    /** Waits until an attempt is drawn with its last message and output. */
    async seeAttempt() {
        await this.see('one more message');
        await this.see('one more line', '.output');
        await this.page.getByText('Loading …').waitFor({ state: 'hidden' });
        await this.button('Copy the command').waitFor();
        await this.see('set-up', '#detail');
    }

    /** A run in the list of runs. */
    run(name) {
        return this.page.locator(`main a[href="#/runs/${name}"]`);
    }

    /** How far the page can be scrolled, and how far its main element. */
    beyond() {
        return this.page.evaluate(() => {
            const { scrollingElement } = document;
            scrollingElement.scrollTop = 1e6;
            const main = document.getElementById('main');
            return [scrollingElement.scrollTop, main.scrollHeight - main.clientHeight];
        });
    }

    button(name) {
        return this.page.getByRole('button', { name, exact: true });
    }

    row(name) {
        return this.page.getByRole('treeitem').filter({ hasText: name });
    }

    /** Waits for a test in the list to be in a state. */
    async rowIs(name, state) {
        await this.page
            .getByRole('treeitem')
            .filter({ hasText: new RegExp(`${state}:\\s*${name}`) })
            .waitFor();
    }

    /** Another tab of the same browser. */
    async tab(url) {
        const tab = new Guarded();
        tab.context = this.context;
        tab.mistakes = this.mistakes;
        tab.page = await this.context.newPage();
        tab.page.setDefaultTimeout(PATIENCE_MS);
        tab.watch(new URL(url).origin);
        await tab.page.goto(url);
        return tab;
    }

    /** Hides or shows the page: in a headless browser, all pages are visible. */
    async hide(isHidden) {
        await this.page.evaluate((value) => {
            Object.defineProperty(document, 'hidden', { value, configurable: true });
            document.dispatchEvent(new Event('visibilitychange'));
        }, isHidden);
    }

    async close() {
        await this.context.close();
        assert.deepEqual(this.mistakes, []);
    }
}
