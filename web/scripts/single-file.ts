// Puts script, style and licences of a built page into its HTML file, with a policy that
// permits nothing else to run.

import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import type { Plugin } from 'vite';

/** rtf replaces this by the data of a run. */
const DATA = '<!--rtf-data-->';

/** `licences` is a file with the licences of the contained packages. */
export function singleFile(fileName: string, licences: URL): Plugin {
    return {
        name: 'single-file',
        enforce: 'post',
        generateBundle(_options, bundle) {
            const page = bundle[fileName];
            if (page?.type !== 'asset') throw new Error(`${fileName} was not built`);
            let html = String(page.source);
            const contents = { script: '', style: '' };
            for (const [name, file] of Object.entries(bundle)) {
                if (name === fileName) continue;
                if (file.type === 'chunk') contents.script += file.code;
                else if (name.endsWith('.css')) contents.style += String(file.source);
                else if (name.endsWith('.svg')) html = html.replaceAll(`./${name}`, image(file));
                else throw new Error(`${name} is not part of ${fileName}`);
                delete bundle[name];
            }
            html = html.replace(/\s*<script\b[^>]*\bsrc=[^>]*><\/script>/g, '');
            html = html.replace(/\s*<link\b[^>]*\brel="(stylesheet|modulepreload)"[^>]*>/g, '');
            const script = inert(contents.script, 'script');
            const style = inert(contents.style, 'style');
            const policy = [
                `default-src 'none'`,
                `script-src ${hash(script)}`,
                `style-src ${hash(style)}`,
                `img-src data: 'self'`,
                `media-src data: 'self'`,
                `base-uri 'none'`,
                `form-action 'none'`,
            ].join('; ');
            const comment = readFileSync(licences, 'utf8').trim().replaceAll('--', '- -');
            page.source = insert(html, [
                ['<meta name="viewport"', (tag) => `${meta(policy)}\n        ${tag}`],
                ['</head>', (tag) => `    <style>${style}</style>\n    ${tag}`],
                [
                    '</body>',
                    (tag) =>
                        `    <script type="module">${script}</script>\n` +
                        `${DATA}\n    ${tag}\n    <!--\n${comment}\n-->`,
                ],
            ]);
        },
    };
}

const image = ({ source }: { source: string | Uint8Array }) =>
    `data:image/svg+xml;base64,${Buffer.from(source).toString('base64')}`;

const meta = (policy: string) =>
    `<meta http-equiv="Content-Security-Policy" content="${policy}" />`;

/** Changes each tag, which the page has once. */
function insert(html: string, changes: [tag: string, change: (tag: string) => string][]): string {
    return changes.reduce((text, [tag, change]) => {
        const [before, after, ...more] = text.split(tag);
        if (after === undefined || more.length > 0) throw new Error(`not one ${tag}`);
        return `${before}${change(tag)}${after}`;
    }, html);
}

/** A text without the end tag of its element, and without the start of a comment. */
function inert(text: string, element: 'script' | 'style'): string {
    const escaped =
        element === 'script'
            ? text.replace(/<(\/script|script|!--)/gi, '\\x3C$1')
            : text.replace(/<(\/style)/gi, '\\3C $1');
    return `\n${escaped.trim()}\n`;
}

const hash = (text: string) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
