// Light that follows a page through many changes and back: in flat memory, to the light of the untouched room.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { LightPages, errorOf, fewest, settled } from './light_pages.js';
import { maeOverMean, meanOf } from './room.js';
import { pixelsOf, rest } from './site.js';

const pages = new LightPages();
before(() => pages.begin());
after(() => pages.end());

// PHAT_SOAK_MOVES makes so many instead of the suite's.
const moves = Number(process.env.PHAT_SOAK_MOVES ?? 40);

// Counts what WebGL is asked to make and to delete: three.js knows of its own objects alone.
function countObjects() {
    const { prototype } = WebGL2RenderingContext;
    window.living = {};
    for (const kind of ['Texture', 'Buffer', 'Framebuffer', 'Renderbuffer', 'Program', 'Shader', 'VertexArray', 'Query']) {
        const [make, remove] = [prototype[`create${kind}`], prototype[`delete${kind}`]],
            objects = new Set();
        prototype[`create${kind}`] = function (...words) {
            const made = make.apply(this, words);
            objects.add(made);
            return made;
        };
        prototype[`delete${kind}`] = function (object) {
            objects.delete(object);
            remove.call(this, object);
        };
        window.living[kind] = objects;
    }
}

const objectsOf = (page) =>
    page.evaluate(() => Object.fromEntries(Object.entries(window.living).map(([kind, { size }]) => [kind, size])));

// After a collection of garbage, bytes.
async function heapOf(session) {
    await session.send('HeapProfiler.collectGarbage');
    return (await session.send('Runtime.getHeapUsage')).usedSize;
}

// The box elsewhere, lamps dimmed and coloured, a material edited; or all as at first. A picture is drawn each time.
const change = (page, numbers) =>
    page.evaluate(async (u) => {
        const { light, scene } = viewer,
            box = scene.getObjectByName('box'),
            { material } = box.isMesh ? box : box.children[0],
            [ceiling, point] = await light.lights;
        window.atFirst ??= { at: box.position.clone(), turn: box.rotation.y, color: material.color.clone() };
        const { at, turn, color } = window.atFirst;
        box.position.copy(at);
        if (u) box.position.x += 2 * u[0];
        box.rotation.y = u ? 6 * u[1] : turn;
        material.color.copy(color);
        if (u && u[2] < 0.5) material.color.setRGB(u[3], u[4], u[5]);
        for (const lamp of [ceiling, point]) lamp.reset();
        if (u) ceiling.intensity = 2 * u[6];
        if (u && u[7] < 0.3) ceiling.color = '#4080ff';
        if (u && u[8] < 0.3) point.visible = false;
        light.updateMilliseconds = Infinity;
        light.waitsForPrograms = true;
        viewer.drawShadows();
        viewer.changed();
        viewer.addSample('fast', 1);
        await new Promise((done) => {
            setTimeout(done);
        });
    }, numbers);

// Numerical Recipes' generator, in [0, 1).
function* numbers(state) {
    for (;;) {
        state = (Math.imul(1664525, state) + 1013904223) >>> 0;
        yield state / 2 ** 32;
    }
}

test('after many changes and back the light is that of the untouched room, in flat memory', async (t) => {
    const file = await pages.bake('soak', { ceiling: 8, point: 6, box: { at: [-1.15, 0, -0.6] } }, { resolution: fewest }),
        page = await pages.open(t, file, { prepare: countObjects }),
        on = { ceiling: { intensity: 1 }, point: { visible: true } };
    await rest(page);
    await page.evaluate(() => viewer.light.followChanges());
    // Anew from the dark, so that nothing is left of the bake, or of what was made before.
    const madeAnew = async () => {
        await settled(page, { ceiling: { intensity: 0 }, point: { visible: false } }, 4);
        await settled(page, on);
        return await pixelsOf(page, 4, 'default');
    };
    const [first, again] = [await madeAnew(), await madeAnew()],
        random = numbers(3),
        session = await page.context().newCDPSession(page),
        heaps = [],
        objects = [];
    for (let i = 0; i < moves; ++i) {
        await change(page, Array.from({ length: 9 }, () => random.next().value));
        if (i !== Math.floor(moves / 3) && i !== moves - 1) continue;
        heaps.push(await heapOf(session));
        objects.push(await objectsOf(page));
    }
    await change(page, null);
    await settled(page, on);
    const back = await pixelsOf(page, 4, 'default'),
        ratio = meanOf(back) / meanOf(first),
        [error, noise] = [back, again].map((picture) => maeOverMean(picture, first)),
        megabytes = heaps.map((bytes) => bytes * 1e-6);
    t.diagnostic(`mean ${ratio.toFixed(4)}, MAE/mean ${error.toFixed(4)}, of the untouched room twice ${noise.toFixed(4)}`);
    t.diagnostic(`heap ${megabytes.map((x) => x.toFixed(2))} MB; ${JSON.stringify(objects[1])}`);
    assert.ok(Math.abs(ratio - 1) < 0.02, `${ratio}`);
    // Beside the box, texels are covered, and depth probes traced, as the page says and not as the bake did: as in moves.test.js.
    assert.ok(error < noise + 0.02, `${error}, untouched ${noise}`);
    assert.deepEqual(objects[1], objects[0]);
    // 40 kB that each of 26 changes leaves behind would be more.
    assert.ok(megabytes[1] < megabytes[0] + 1, `${megabytes}`);
    assert.equal(await errorOf(page), 0);
    assert.deepEqual(page.problems, []);
});
