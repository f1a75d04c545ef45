// Shows a run, or all runs, in a real Chromium, for benches/lines/watched.py and tools/soak.py:
//
//   node watch.mjs URL     prints `open` once they are shown, and continues until its input ends

import { once } from 'node:events';
import { Guarded, launch } from './support/browser.mjs';

const browser = await launch();
const guarded = await Guarded.open(browser, process.argv[2]);
const { page } = guarded;
await page.getByRole('treeitem').or(page.getByLabel('Search runs')).first().waitFor();
process.stdout.write('open\n');
process.stdin.resume();
await once(process.stdin, 'end');
await guarded.close();
await browser.close();
