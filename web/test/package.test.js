// What needs no browser: the package, its tables, its size.
import assert from 'node:assert/strict';
import { readFile, readdir } from 'node:fs/promises';
import { test } from 'node:test';
import { sampleNumberTables, jitterOf, sobolBits } from '../src/sample_numbers.js';
import { packMaterial } from '../src/material.js';
import { requireRevision, uploadTexture, webglTexture } from '../src/three_internals.js';
import { lightOfEnvironment } from './bare_light.js';
import { DataTexture, MeshPhysicalMaterial, REVISION, Texture } from 'three';

const dist = new URL('../dist/', import.meta.url);

test('the README files show the example that is tested', async () => {
    const [example, ...readmes] = await Promise.all(
        ['../examples/importmap/main.js', '../../README.md', '../README.md'].map((name) =>
            readFile(new URL(name, import.meta.url), 'utf8'),
        ),
    );
    for (const readme of readmes) assert.ok(readme.includes(example));
});

test('what is sent is small', async () => {
    const sizes = JSON.parse(await readFile(new URL('sizes.json', dist)));
    assert.ok(sizes.gzip < 300_000, `${sizes.gzip} bytes`);
    assert.ok(sizes.ownGzip < 65_000, `${sizes.ownGzip} bytes of ours`);
});

test("Sobol's first points", () => {
    // Joe and Kuo's table: 0; 1/2; 3/4 and 1/4 ...
    const eighths = (index) => sobolBits(index).map((bits) => (bits / 2 ** 32) * 8);
    assert.deepEqual(eighths(0), [0, 0, 0, 0]);
    assert.deepEqual(eighths(1), [4, 4, 4, 4]);
    assert.deepEqual([2, 3].map((i) => eighths(i)[0]).sort(), [2, 6]);
    // Each dimension of an aligned run of 16 has one point in each sixteenth.
    for (let d = 0; d < 4; ++d) {
        const strata = new Set(Array.from({ length: 16 }, (_, i) => sobolBits(32 + i)[d] >>> 28));
        assert.equal(strata.size, 16);
    }
});

test('ranks are aligned runs and seeds shift all draws alike', () => {
    const a = sampleNumberTables(12, 1),
        b = sampleNumberTables(12, 2);
    assert.deepEqual(a.ranks, b.ranks);
    const shift = a.sampleNumbers[0] ^ b.sampleNumbers[0];
    assert.notEqual(shift, 0);
    for (let k = 0; k < 32; ++k) assert.equal(a.sampleNumbers[4 * k] ^ b.sampleNumbers[4 * k], shift);
});

test('jitter is centred in the pixel', () => {
    for (const axis of [0, 1]) {
        const mean =
            Array.from({ length: 16 }, (_, i) => jitterOf(i, 16)[axis]).reduce((sum, x) => sum + x) / 16;
        assert.ok(Math.abs(mean) < 1e-6);
    }
    assert.deepEqual(jitterOf(0, 1), [0, 0]);
});

test('materials become rows as the shaders read them', () => {
    const map = new Texture();
    map.channel = 1;
    map.offset.set(0.25, 0.5);
    map.repeat.set(2, 3);
    const material = new MeshPhysicalMaterial({ roughness: 0.25, metalness: 0.5, clearcoat: 0.75, map });
    material.color.setRGB(0.1, 0.2, 0.3);
    const rows = packMaterial(material),
        row = (i) => [...rows.slice(4 * i, 4 * i + 4)];
    const near = (a, b) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) < 1e-6, `${a} and ${b}`));
    near(row(0), [0.1, 0.2, 0.3, 1]);
    near(row(2), [0.5, 0.25, 1, 1.5]);
    near(row(4), [0.75, 0, 1, 0]);
    near(row(5), [0, 0, 0, 0]); // no glass
    near(row(7), [2, 0, 0.25, 1]); // u = 2 u0 + .25, of the second UV set
    near(row(8), [0, 3, 0.5, 1]);
    assert.equal(row(10)[3], 0); // no metallicRoughness texture
    near([...packMaterial(new MeshPhysicalMaterial({ transmission: 0.75 })).slice(20, 21)], [0.75]);
});

test('an environment that arrives after detach() is not kept', async () => {
    for (const isDetached of [false, true]) {
        const { light, deliver } = await lightOfEnvironment();
        if (isDetached) light.detach();
        deliver();
        await light.ready;
        assert.equal(light.environment === null, isDetached);
    }
});

// A renderer that keeps textures as three.js does, under `names`.
function rendererWith(names) {
    const all = new Map();
    const get = (texture) => all.get(texture) ?? all.set(texture, {}).get(texture);
    const renderer = { uploads: 0, properties: { get } };
    renderer.initTexture = (texture) => {
        ++renderer.uploads;
        Object.assign(get(texture), { [names.handle]: 'handle', [names.version]: texture.version });
    };
    return renderer;
}

test('textures are uploaded once a version', () => {
    const renderer = rendererWith({ handle: '__webglTexture', version: '__version' });
    const texture = new DataTexture(new Uint8Array(4), 1, 1);
    assert.equal(webglTexture(renderer, texture), undefined);
    for (const uploads of [1, 1, 2]) {
        if (uploads !== renderer.uploads) texture.needsUpdate = true;
        uploadTexture(renderer, texture);
        assert.equal(renderer.uploads, uploads);
        assert.equal(webglTexture(renderer, texture), 'handle');
    }
    uploadTexture(renderer, new Texture()); // without an image there is nothing to upload
    assert.equal(renderer.uploads, 2);
});

test('a three.js that keeps its textures otherwise is told from one that does not', () => {
    for (const names of [
        { handle: '__handle', version: '__version' },
        { handle: '__webglTexture', version: '__uploaded' },
    ]) {
        const texture = new DataTexture(new Uint8Array(4), 1, 1);
        texture.needsUpdate = true;
        assert.throws(() => uploadTexture(rendererWith(names), texture), new RegExp(`r${REVISION}: it keeps`));
    }
    assert.throws(() => requireRevision('179'), /r179: it needs r180 or newer/);
    assert.throws(() => requireRevision('next'), /needs r180/);
    for (const revision of ['180', '187', '188dev', REVISION]) requireRevision(revision);
});

test('the first revision is the one of peerDependencies', async () => {
    const { peerDependencies } = JSON.parse(await readFile(new URL('../package.json', import.meta.url)));
    const [, revision] = peerDependencies.three.match(/^>=0\.(\d+)$/);
    requireRevision(revision);
    assert.throws(() => requireRevision(String(Number(revision) - 1)));
});

test('one file alone uses what three.js does not document', async () => {
    const folder = new URL('../src/', import.meta.url);
    for (const name of await readdir(folder)) {
        const text = await readFile(new URL(name, folder), 'utf8');
        const isInternal = /\.properties\b|\b__\w+/.test(text);
        assert.equal(isInternal, name === 'three_internals.js', name);
    }
});
