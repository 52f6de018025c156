// Light that follows what a page moves, against bakes of the room as it is then.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { LightPages, errorOf, rendered, settled } from './light_pages.js';
import { maeOverMean, meanOf } from './room.js';
import { pixelsOf, rest } from './site.js';

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
        again = await rendered(await pages.bake('end-again', { ...lamps, box: end }, '--seed', '2'));
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
