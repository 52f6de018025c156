// What needs no browser: the package, its tables, its size.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { test } from 'node:test';
import { drawsOf, jitterOf, sobolBits } from '../src/draws.js';
import { packMaterial } from '../src/material.js';
import { MeshPhysicalMaterial, Texture } from 'three';

const dist = new URL('../dist/', import.meta.url);

test('the README shows the example that is tested', async () => {
    const [readme, example] = await Promise.all(
        ['../../README.md', '../examples/plugin.js'].map((name) =>
            readFile(new URL(name, import.meta.url), 'utf8'),
        ),
    );
    assert.ok(readme.includes(example));
});

test('what is sent is small', async () => {
    const sizes = JSON.parse(await readFile(new URL('sizes.json', dist)));
    assert.ok(sizes.gzip < 300_000, `${sizes.gzip} bytes`);
    assert.ok(sizes.ownGzip < 40_000, `${sizes.ownGzip} bytes of ours`);
});

test('the package exports what its types declare', async () => {
    const {
        BakedLight,
        PhatexturesExtension,
        isSupported,
        jitterOf: jitter,
    } = await import('../dist/phatextures.js');
    const types = await readFile(new URL('../src/index.d.ts', import.meta.url), 'utf8');
    const declared = [...types.matchAll(/export (?:class|function) (\w+)/g)].map(([, name]) => name);
    assert.deepEqual(
        declared.sort(),
        Object.keys({ BakedLight, PhatexturesExtension, isSupported, jitterOf: jitter }).sort(),
    );
    for (const exported of [BakedLight, PhatexturesExtension, isSupported, jitter])
        assert.equal(typeof exported, 'function');
    assert.equal(new PhatexturesExtension({}).name, 'PHAT_photon_accumulation_texture');
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
    const a = drawsOf(12, 1),
        b = drawsOf(12, 2);
    assert.deepEqual(a.ranks, b.ranks);
    const shift = a.draws[0] ^ b.draws[0];
    assert.notEqual(shift, 0);
    for (let k = 0; k < 32; ++k) assert.equal(a.draws[4 * k] ^ b.draws[4 * k], shift);
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
    near(row(5), [2, 0, 0.25, 1]); // u = 2 u0 + .25, of the second UV set
    near(row(6), [0, 3, 0.5, 1]);
    assert.equal(row(8)[3], 0); // no metallicRoughness texture
});
