// ESLint's rules, as `npm run lint` checks them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { ESLint } from 'eslint';

test('ESLint finds nothing', async () => {
    const results = await new ESLint({ cwd: new URL('..', import.meta.url).pathname }).lintFiles('.');
    const findings = results.flatMap(({ filePath, messages }) =>
        messages.map(({ line, message, ruleId }) => `${filePath}:${line}: ${message} (${ruleId})`),
    );
    assert.ok(results.length > 0);
    assert.deepEqual(findings, []);
});
