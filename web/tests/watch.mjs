// Looks at a run in a real Chromium, for benches/lines/watched.py:
//
//   node watch.mjs URL     prints `open` once tests are shown, and looks on until its input ends

import { Guarded, launch } from './support/browser.mjs';

const browser = await launch();
const guarded = await Guarded.open(browser, process.argv[2]);
await guarded.page.getByRole('treeitem').first().waitFor();
process.stdout.write('open\n');
for await (const _ of process.stdin);
await guarded.close();
await browser.close();
