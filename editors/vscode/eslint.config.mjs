import ts from 'typescript-eslint';

export default ts.config(
    { ignores: ['dist/', 'node_modules/', 'schemas/'] },
    ...ts.configs.recommended,
    { rules: { 'max-lines': ['error', 300], 'max-params': ['error', 5] } },
    {
        // Tests of these run without VS Code.
        files: ['src/logic/**'],
        rules: { 'no-restricted-imports': ['error', 'vscode'] },
    },
);
