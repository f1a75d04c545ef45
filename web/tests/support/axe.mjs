// Checks the accessibility of a page with axe.

import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';

const AXE = await readFile(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** Rules that are disabled, or that axe rates lower than we do. */
const RULES = ['target-size', 'region', 'empty-table-header', 'page-has-heading-one'];

/** Serious violations that axe finds, one line each. */
export async function violations({ page }) {
    await page.evaluate(AXE);
    const options = { rules: Object.fromEntries(RULES.map((rule) => [rule, { enabled: true }])) };
    const { violations: found } = await page.evaluate(
        (given) => globalThis.axe.run(given),
        options,
    );
    return found
        .filter(
            ({ id, impact }) => RULES.includes(id) || impact === 'serious' || impact === 'critical',
        )
        .flatMap(({ id, nodes }) => nodes.map(({ html }) => `${id}: ${html.slice(0, 160)}`));
}
