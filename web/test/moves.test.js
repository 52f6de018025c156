// Light that follows what a page moves, against bakes of the room as it is then.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { LightPages, errorOf, fewest, rendered, settled } from './light_pages.js';
import { maeOverMean, meanOf } from './room.js';
import { eyeOf, forwardOf, pixelsOf, rest } from './site.js';

const pages = new LightPages();
before(() => pages.begin());
after(() => pages.end());

const lamps = { ceiling: 8, point: 6 },
    start = { at: [-1.15, 0, -0.6] },
    end = { at: [1.05, 0, -0.5], turn: 0.4 };

// Of pictures of 160 x 90, from the top: the floor on which the box has stood, and where the plate reflects it now.
const uncovered = [28, 79, 48, 88],
    reflected = [106, 77, 122, 90];
const inside = (all, [left, top, right, bottom]) =>
    all.filter((_, i) => {
        const pixel = i >> 2,
            [x, y] = [pixel % 160, 89 - Math.floor(pixel / 160)];
        return x >= left && x < right && y >= top && y < bottom;
    });

const moveBox = (page, { at, turn }) =>
    page.evaluate(
        ([[x, y, z], angle]) => {
            const box = viewer.scene.getObjectByName('box');
            box.position.set(x, y, z);
            box.rotation.y = angle;
            viewer.drawShadows();
        },
        [at, turn ?? 0],
    );

test('a box that the page moves is where the light is of a bake with it there', async (t) => {
    const page = await pages.open(t, await pages.bake('start', { ...lamps, box: start })),
        expected = await rendered(await pages.bake('end', { ...lamps, box: end })),
        again = await rendered(await pages.bake('end-again', { ...lamps, box: end }, { seed: '2' }));
    await rest(page);
    await page.evaluate(() => viewer.light.followChanges());
    await moveBox(page, end);
    const moved = await pixelsOf(page, 4, 'default');
    assert.equal(await page.evaluate(() => viewer.light.isSettled), false);
    await settled(page, {});
    const pixels = await pixelsOf(page, 4, 'default'),
        ratio = meanOf(pixels) / meanOf(expected),
        [error, noise, before] = [pixels, again, moved].map((picture) => maeOverMean(picture, expected));
    t.diagnostic(
        `mean ${ratio.toFixed(4)}, MAE/mean ${error.toFixed(4)}; of another bake ${noise.toFixed(4)}, just moved ${before.toFixed(4)}`,
    );
    // As of lamps: lights.test.js.
    assert.ok(Math.abs(ratio - 1) < 0.02, `${ratio}`);
    for (const [name, part] of Object.entries({ uncovered, reflected })) {
        const [own, others, last] = [pixels, again, moved].map((picture) =>
            maeOverMean(inside(picture, part), inside(expected, part)),
        );
        t.diagnostic(`${name}: ${own.toFixed(4)}; of another bake ${others.toFixed(4)}, just moved ${last.toFixed(4)}`);
        assert.ok(own < others + 0.02, `${name}: ${own}, another bake ${others}`);
    }
    assert.ok(error < noise + 0.02, `${error}, another bake ${noise}`);
    assert.equal(await errorOf(page), 0);
    assert.deepEqual(page.problems, []);
});

const placeOf = (page) => page.evaluate(() => viewer.scene.getObjectByName('box').position.toArray());

test('a box that is movable is dragged over the floor, and its light follows', async (t) => {
    const page = await pages.open(t, await pages.bake('movable', { ...lamps, box: { ...end, movable: true } }, { resolution: fewest }));
    await page.waitForFunction(() => viewer.moves);
    assert.match(await page.textContent('#motionstate'), /dragged: box/);
    assert.ok(await page.isHidden('#play'));
    const [eye, forward, before] = [await eyeOf(page), await forwardOf(page), await placeOf(page)];
    // The middle of the box on the screen.
    const [x, y] = await page.evaluate(() => {
        const { x, y } = viewer.scene.getObjectByName('box').position.clone().setY(0.5).project(viewer.camera);
        return [((1 + x) / 2) * innerWidth, ((1 - y) / 2) * innerHeight];
    });
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x - 30, y, { steps: 3 });
    await page.mouse.up();
    const after = await placeOf(page);
    assert.ok(after[0] < before[0] - 0.2 && after[1] === before[1], `${before} to ${after}`);
    assert.deepEqual([await eyeOf(page), await forwardOf(page)], [eye, forward]);
    await page.waitForFunction(() => viewer.light.updates?.points && !viewer.light.isSettled);
    // What is not movable turns the view.
    await page.mouse.move(20, 20);
    await page.mouse.down();
    await page.mouse.move(60, 20, { steps: 3 });
    await page.mouse.up();
    assert.notDeepEqual(await forwardOf(page), forward);
    assert.deepEqual(await placeOf(page), after);
    assert.deepEqual(page.problems, []);
});

test("the file's animation plays, and its light follows", async (t) => {
    const page = await pages.open(t, await pages.bake('animated', { ...lamps, box: { ...start, travels: end.at } }, { resolution: fewest }));
    await page.waitForFunction(() => viewer.moves);
    await page.click('#settings');
    assert.equal(await page.textContent('#play'), 'Play');
    assert.deepEqual(await placeOf(page), start.at);
    await page.click('#play');
    await page.waitForFunction((x) => viewer.scene.getObjectByName('box').position.x !== x, start.at[0]);
    await page.waitForFunction(() => viewer.light.updates?.points && !viewer.light.isSettled);
    await page.click('#play');
    const [x, y, z] = await placeOf(page),
        part = (x - start.at[0]) / (end.at[0] - start.at[0]);
    assert.ok(part > 0 && part < 1 && y === 0, `${part}, ${y}`);
    assert.ok(Math.abs(z - start.at[2] - part * (end.at[2] - start.at[2])) < 1e-5, `${z}`);
    assert.deepEqual(page.problems, []);
});
