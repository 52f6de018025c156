// Rules that find defects; the form of the code is Prettier's matter.
import js from '@eslint/js';
import globals from 'globals';

// What the page of `phat web`, test/plugin.html and pages of tests have.
const ofPages = Object.fromEntries(
    (
        'viewer THREE renderer countAlive workOf load loadPlain meshesOf draw readCanvas readTarget ' +
        'meshesOfRoom withRenderer drawBy element applied told axe parts contexts shown device statuses'
    )
        .split(' ')
        .map((name) => [name, 'readonly']),
);
const inBrowsers = ['src/**', 'viewer/**', 'examples/**', 'bench/peer.js'];

export default [
    { ignores: ['dist/'] },
    js.configs.recommended,
    {
        languageOptions: { globals: globals.node },
        linterOptions: { reportUnusedDisableDirectives: 'error' },
        rules: {
            'array-callback-return': 'error',
            'no-constructor-return': 'error',
            'no-self-compare': 'error',
            'no-template-curly-in-string': 'error',
            'no-unused-vars': ['error', { caughtErrors: 'all', ignoreRestSiblings: true }],
            'no-use-before-define': ['error', { functions: false, classes: false, variables: false }],
            'no-useless-assignment': 'error',
            'no-var': 'error',
            'prefer-const': ['error', { destructuring: 'all', ignoreReadBeforeAssign: true }],
            eqeqeq: 'error',
        },
    },
    { files: inBrowsers, languageOptions: { globals: globals.browser } },
    // Functions of tests run in pages, too.
    { files: ['test/**', 'bench/bench.js'], languageOptions: { globals: { ...globals.browser, ...ofPages } } },
];
