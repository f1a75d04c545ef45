import { expect, test } from 'vitest';
import { parseProblems } from './problems';

const TEXT = `error: there is no plug-in \`C.lua\` of type \`lua\`
 --> suites/arm.xml:4:22
  |
4 |   <test name="Cases">C.lua</test>
  |                      ^^^^^
  |
  = note: looked for \`C.lua\` in
            suites

warning: the suite has no description
 --> suites/arm.xml:1:1

error: no position

1 error; nothing was started
`;

test('each problem has the position of its first label', () => {
    const at = { file: 'suites/arm.xml' };
    expect(parseProblems(TEXT)).toEqual([
        {
            ...at,
            severity: 'error',
            message: 'there is no plug-in `C.lua` of type `lua`',
            line: 4,
            column: 22,
        },
        {
            ...at,
            severity: 'warning',
            message: 'the suite has no description',
            line: 1,
            column: 1,
        },
    ]);
});
