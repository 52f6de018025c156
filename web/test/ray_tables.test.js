// What needs no browser of the page's rays: how many there are, and their tables.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Object3D, PointLight, Scene, SpotLight } from 'three';
import { aliasTable } from '../src/alias_table.js';
import { brightestRadiance } from '../src/hit_tables.js';
import { lightTable } from '../src/light_table.js';
import { costAfter, costFromLookup, kMaxLevel, levelFor, raysOf } from '../src/ray_budget.js';
import { placeNumbers, sobolBits } from '../src/sample_numbers.js';
import { gridOver, packNode } from '../src/trees.js';
import { kVertexWords } from '../src/surfaces.js';

test('the highest level has as many rays as phat render', () => {
    assert.deepEqual(raysOf(kMaxLevel), { raysPerNeighborhood: 24, maxRays: 8, lightSamples: 1 });
    assert.deepEqual(raysOf(1), { raysPerNeighborhood: 3, maxRays: 1, lightSamples: 1 });
});

test('rays are as many as fit into the time, and none where there is too little', () => {
    const levelOf = (cost, last = kMaxLevel) => levelFor({ cost, pixels: 1000, milliseconds: 8, last });
    assert.deepEqual([0.0005, 0.001, 0.0011, 0.002, 0.005, 0.008, 0.0081].map((cost) => levelOf(cost)), [4, 4, 3, 3, 1, 1, 0]);
    assert.equal(levelFor({ cost: 0.001, pixels: 4000, milliseconds: 8, last: 4 }), 2);
    assert.equal(levelFor({ cost: 0.001, pixels: 1000, milliseconds: 0, last: 4 }), 0);
});

test('a slower GPU loses rays at once, a faster one gets them back, and nothing alternates', () => {
    const view = { pixels: 1000, milliseconds: 8 };
    // What a device takes for a pixel at level 1, picture by picture.
    const levelsOf = (costs) => {
        let cost = 0.004,
            last = 0;
        return costs.map((now) => {
            const level = levelFor({ ...view, cost, last });
            cost = costAfter(cost, { level, pixels: 1000, milliseconds: now * 1000 * 2 ** (level - 1) });
            last = level;
            return level;
        });
    };
    const repeated = (cost, n) => Array(n).fill(cost);
    const steady = levelsOf(repeated(0.0021, 200)).slice(50);
    assert.equal(new Set(steady).size, 1, steady.join(''));
    const levels = levelsOf([...repeated(0.0005, 40), ...repeated(0.05, 3), ...repeated(0.0005, 1000)]);
    assert.equal(levels[39], 4);
    assert.equal(levels[41], 0, 'the picture after a slow one');
    assert.ok(levels.slice(42, 100).every((level) => level === 0), 'for a while');
    assert.equal(levels.at(-1), 4, 'in the end');
});

test('the first cost is that of the lookup, whatever its quality', () => {
    const fast = costFromLookup({ pixels: 1000, milliseconds: 1, relativeCost: 1 }),
        high = costFromLookup({ pixels: 1000, milliseconds: 8, relativeCost: 8 });
    assert.equal(fast, high);
    assert.ok(fast > 0.001);
});

test('an alias table chooses as its probabilities say', () => {
    const probabilities = [0.5, 0.05, 0.15, 0.3],
        { thresholds, aliases } = aliasTable(probabilities),
        sums = [0, 0, 0, 0];
    thresholds.forEach((threshold, i) => {
        sums[i] += threshold / 4;
        sums[aliases[i]] += (1 - threshold) / 4;
    });
    sums.forEach((sum, i) => assert.ok(Math.abs(sum - probabilities[i]) < 1e-12, `${sums}`));
});

test('boxes of a node are rounded outwards', () => {
    const boxes = [
            { low: [-1, 0, 2], high: [0.3, 0, 2.1] },
            { low: [0.31, -3e-5, 1.9], high: [7, 5, 2.05] },
        ],
        words = new Uint32Array(12),
        floats = new Float32Array(words.buffer);
    packNode(words, 0, boxes, 77);
    assert.equal(words[3] >>> 24, 2);
    assert.equal(words[10] >>> 8, 77);
    for (const [child, box] of boxes.entries())
        for (let axis = 0; axis < 3; ++axis) {
            const unit = 2 ** (((words[3] >>> (8 * axis)) & 255) - 127),
                at = (word) => floats[axis] + ((words[word + axis] >>> (8 * child)) & 255) * unit;
            assert.ok(at(4) <= box.low[axis] + 1e-12 && at(4) > box.low[axis] - unit - 1e-6);
            assert.ok(at(7) >= box.high[axis] && at(7) <= box.high[axis] + unit);
        }
    for (const child of [2, 3]) assert.equal((words[4] >>> (8 * child)) & 255, 255, 'turned inside out');
});

test('the grid of the corners is that of the file', () => {
    const floats = new Float32Array(2 * kVertexWords);
    floats.set([3, -4, 0.49], kVertexWords);
    assert.deepEqual(gridOver(floats), [2 ** (2 - 27), 2 ** (3 - 27), 2 ** (-1 - 27)]);
});

test("numbers of places are Sobol's points 1, 2, 4 ...", () => {
    const numbers = placeNumbers();
    for (let i = 0; i < 9; ++i) assert.deepEqual([...numbers.subarray(4 * i, 4 * i + 4)], sobolBits(2 ** i));
});

test('lights are as bright in the space of a room that is scaled', () => {
    const scene = new Scene(),
        root = new Object3D(),
        point = new PointLight(0xffffff, 8, 6),
        spot = new SpotLight(0xff0000, 1, 0, 0.5, 0.25);
    root.scale.setScalar(2);
    root.position.set(1, 0, 0);
    scene.add(root, spot, spot.target);
    root.add(point);
    point.position.set(3, 0, 0);
    spot.position.set(1, 2, 0);
    scene.updateMatrixWorld(true);
    const { rows, count } = lightTable(root, 1);
    assert.equal(count, 2);
    assert.deepEqual([...rows.subarray(0, 8)], [3, 0, 0, 0, 2, 2, 2, 3]);
    const [x, y, z, type] = rows.subarray(20);
    assert.deepEqual([x, y, z, type], [0, 1, 0, 1]);
    assert.ok(Math.abs(rows[31] - Math.cos(0.375)) < 1e-6 && Math.abs(rows[32] - Math.cos(0.5)) < 1e-6);
    point.visible = false;
    assert.equal(lightTable(root, 1).count, 1);
});

test('radiance is bounded by black lamps and the sky alone', () => {
    const color = (r, g, b) => ({ toArray: () => [r, g, b] });
    const lamp = {
        isMeshStandardMaterial: true,
        color: color(0, 0, 0),
        emissive: color(1, 2, 3),
        emissiveIntensity: 2,
        metalness: 1,
    };
    assert.deepEqual(brightestRadiance([lamp], null, 0), [2, 4, 6]);
    assert.deepEqual(brightestRadiance([lamp], [9, 0, 0, 1], 0), [9, 4, 6]);
    assert.equal(brightestRadiance([lamp], null, 1)[0], 1e30);
    assert.equal(brightestRadiance([{ ...lamp, color: color(1, 0, 0) }], null, 0)[0], 1e30);
});
