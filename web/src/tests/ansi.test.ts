import { describe, expect, test } from 'vitest';
import { AnsiReader, oneLine, plain, visible } from '../lib/ansi';

const read = (text: string) =>
    new AnsiReader()
        .read(text)
        .map(({ text: shown, classes, color, background }) =>
            [shown, classes, color, background].filter((each) => each).join('|'),
        );

describe('colours', () => {
    test.each([
        ['plain', ['plain']],
        ['\x1b[31mred\x1b[0m none', ['red|ansi-red', ' none']],
        ['\x1b[1;4;92mx', ['x|ansi-bold ansi-underline ansi-bright-green']],
        ['\x1b[41mx\x1b[49my', ['x|ansi-on-red', 'y']],
        ['\x1b[1mx\x1b[22my', ['x|ansi-bold', 'y']],
        ['\x1b[7mx\x1b[27my', ['x|ansi-inverse', 'y']],
        ['\x1b[38;5;9mx', ['x|ansi-bright-red']],
        ['\x1b[38;5;196mx', ['x|rgb(255, 0, 0)']],
        ['\x1b[48;5;244mx', ['x|rgb(128, 128, 128)']],
        ['\x1b[38;2;1;2;300mx\x1b[39my', ['x|rgb(1, 2, 255)', 'y']],
        ['\x1b[mx', ['x']],
        ['\x1b[38mx', ['x']],
    ])('%j', (text, pieces) => {
        expect(read(text)).toEqual(pieces);
    });

    test('continue from one piece of output to the next', () => {
        const reader = new AnsiReader();
        reader.read('\x1b[32mgreen');
        expect(reader.read('still')[0]?.classes).toBe('ansi-green');
    });
});

describe('other terminal commands are removed', () => {
    test.each([
        ['\x1b[2J\x1b[Hcleared', 'cleared'],
        ['\x1b]0;owned\x07title', 'title'],
        ['\x1b]8;;http://x\x1b\\link\x1b]8;;\x1b\\', 'link'],
        ['\x1bPq#0\x1b\\sixel', 'sixel'],
        ['\x1b(Bcharset', 'charset'],
        ['\x9b31mc1', 'c1'],
    ])('%j', (text, shown) => {
        expect(plain(text)).toBe(shown);
    });

    test('an unterminated string hides nothing', () => {
        expect(plain('\x1b]0;the rest stays')).toContain('the rest stays');
    });

    test('a megabyte of introducers is read in no time', () => {
        const started = performance.now();
        plain('\x1b]'.repeat(500_000));
        plain('\x1b['.repeat(500_000));
        expect(performance.now() - started).toBeLessThan(2000);
    });
});

describe('characters that cannot be seen', () => {
    test.each([
        ['a\0b', 'a⟨NUL⟩b'],
        ['a\r\nb', 'a\nb'],
        ['1%\r2%', '1%⟨CR⟩2%'],
        ['\x7f\x85', '⟨DEL⟩⟨U+0085⟩'],
        ['gnp.\u202eexe', 'gnp.⟨U+202E⟩exe'],
        ['🤖 größe', '🤖 größe'],
    ])('%j', (text, shown) => {
        expect(visible(text)).toBe(shown);
    });

    test('a name stays on its line', () => {
        expect(oneLine('line\nbreak\ttab')).toBe('line⟨LF⟩break⟨TAB⟩tab');
    });
});
