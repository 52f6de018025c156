// The package as npm would publish it. Needs no browser.
import assert from 'node:assert/strict';
import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { before, after, test } from 'node:test';
import { Package, checkPackage } from '@arethetypeswrong/core';
import { publint } from 'publint';
import { borrowPacked, run } from './packed.js';

const web = new URL('..', import.meta.url).pathname;
let folder, packed, dispose;

before(async () => {
    folder = await mkdtemp(join(tmpdir(), 'phat-unpacked-'));
    const borrowed = await borrowPacked();
    ({ dispose } = borrowed);
    packed = borrowed.value.about;
    await run('tar', ['-xzf', borrowed.value.tarball], { cwd: folder });
});
after(async () => {
    await rm(folder, { recursive: true });
    await dispose?.();
});

const own = (name) => readFile(join(folder, 'package', name), 'utf8');

test('it holds what its users need, and no more', () => {
    const names = packed.files.map(({ path }) => path).filter((path) => !/^dist\/\w+\.js(\.map)?$/.test(path));
    assert.deepEqual(names.sort(), ['LICENSE', 'README.md', 'dist/THIRD_PARTY.txt', 'package.json', 'src/index.d.ts']);
    assert.ok(packed.size < 400_000, `${packed.size} bytes`);
});

test('its licences are ours and that of three.js, of whose shaders it has parts', async () => {
    assert.match(await own('LICENSE'), /^MIT License\n\nCopyright \(c\) \d+ The PHATextures authors/);
    assert.match(await own('dist/THIRD_PARTY.txt'), /three\.js authors/);
});

test('its source maps lead to its sources', async () => {
    const scripts = packed.files.map(({ path }) => path).filter((path) => path.endsWith('.js')),
        sources = new Map();
    assert.ok(scripts.length > 1);
    for (const name of scripts) {
        const [, map] = (await own(name)).match(/\/\/# sourceMappingURL=(.*)\n?$/),
            { sources: names, sourcesContent } = JSON.parse(await own(`dist/${map}`));
        names.forEach((source, i) => sources.set(source, sourcesContent[i]));
    }
    assert.equal(sources.get('../src/extension.js'), await readFile(join(web, 'src/extension.js'), 'utf8'));
});

test('publint finds nothing', async () => {
    const { messages } = await publint({ pkgDir: join(folder, 'package'), strict: true, pack: false });
    assert.deepEqual(messages, []);
});

test('Are the types wrong? finds nothing', async () => {
    const contents = packed.files.map(async ({ path }) => [`/node_modules/phatextures/${path}`, await own(path)]),
        files = Object.fromEntries(await Promise.all(contents)),
        { problems } = await checkPackage(new Package(files, packed.name, packed.version));
    // The package has modules alone, as three.js's addons: what is required from CommonJS resolves to one.
    const found = problems.filter(({ kind }) => kind !== 'CJSResolvesToESM');
    assert.deepEqual(found, []);
});
