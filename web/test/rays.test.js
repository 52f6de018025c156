// Reflections that the page traces, beside the pictures of `phat render --trace gpu`.
import assert from 'node:assert/strict';
import { cp, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { borrowBrowser, serve } from './browser.js';
import { mirrorRoom } from './mirror_room.js';
import { borrowRoom, maeOverMean, meanOf, partOf, phat, readExr, smallPoster } from './room.js';
import { skyYard, sunnySky } from './sky_yard.js';
import { loaded, loseContext, open, openPlugin, pixelsOf, rest } from './site.js';

const size = { width: 160, height: 90 };
let folder, mirror, mesa;

// Returns the file.
async function baked(name, scene, resolution, ...options) {
    const [from, file] = [`${name}.glb`, `${name}.phat.glb`].map((part) => join(folder, part));
    await writeFile(from, scene);
    await phat('bake', from, '-o', file, '--resolution', resolution, ...options, '--quiet');
    return file;
}

before(async () => {
    folder = await mkdtemp(join(tmpdir(), 'phat-rays-'));
    const site = join(folder, 'mirror');
    mirror = { file: await baked('mirror', mirrorRoom(), '60k', '--photons', '50k'), site };
    await phat('web', mirror.file, '-o', site, ...smallPoster, '--quiet');
    mesa = await borrowBrowser('gl-egl');
});
after(async () => {
    await mesa?.dispose();
    if (folder) await rm(folder, { recursive: true });
});

// The page of a site at rest, and what it shows by rays.
async function openAt(t, site) {
    const server = await serve(site);
    let page;
    t.after(async () => {
        await page?.close();
        server.close();
    });
    page = await loaded(await open(mesa.value, server.url, { size }));
    await rest(page);
    return page;
}

// Reads the trees first, which pictures do not wait for.
async function tracedPixels(page, reflections = 'rays', count = 4) {
    await page.evaluate(async (r) => {
        Object.assign(viewer.light, { reflections: r, reflectionMilliseconds: Infinity });
        await viewer.light.loadTrees();
    }, reflections);
    return pixelsOf(page, count, 'default', reflections);
}

async function rendered(file, ...options) {
    const reference = join(folder, `reference${options.join('')}.exr`);
    const view = ['--spp', '4', '--quiet', '--size', `${size.width}x${size.height}`];
    await phat('render', file, '-o', reference, ...view, ...options);
    return (await readExr(reference)).pixels;
}

// RGBA of the pixels inside a rectangle, or outside of it: columns and rows from the top.
function part(all, [left, top, right, bottom], isInside) {
    return all.filter((_, i) => {
        const x = Math.floor(i / 4) % size.width,
            y = size.height - 1 - Math.floor(i / 4 / size.width);
        return (x >= left && x < right && y >= top && y < bottom) === isInside;
    });
}

// As in pictures.test.js: the samples and the shaders are the same. Rays to lights take the place of shadow maps, and
// pictures at hits are shrunk in linear light. `noisy`: a rectangle in which rays pass surfaces by random numbers of
// their last bits, which rounding changes; its mean must agree.
async function compare(t, { file, site }, reflections, noisy = [0, 0, 0, 0]) {
    const page = await openAt(t, site);
    const whole = await tracedPixels(page, reflections),
        wholes = [
            whole,
            await rendered(file, '--trace', 'gpu', '--reflections', reflections),
            await rendered(file, '--reflections', 'lookup'),
        ];
    const [pixels, expected, lookedUp] = wholes.map((all) => part(all, noisy, false)),
        means = wholes.map((all) => meanOf(part(all, noisy, true)));
    if (noisy[2] > 0) {
        t.diagnostic(`noisy: ${(means[0] / means[1] - 1).toFixed(5)}`);
        assert.ok(Math.abs(means[0] / means[1] - 1) < 0.03, `${means}`);
    }
    const error = maeOverMean(pixels, expected),
        apart = maeOverMean(lookedUp, expected);
    t.diagnostic(`MAE/mean ${error.toFixed(5)}; of the lookup ${apart.toFixed(5)}`);
    assert.ok(error < 0.01, `MAE/mean ${error}`);
    assert.ok(error < 0.1 * apart, `${error}, and the lookup is ${apart} apart`);
    assert.ok(await page.evaluate(() => viewer.light.tracedMilliseconds > 0));
    assert.equal(await page.evaluate(() => viewer.renderer.getContext().getError()), 0);
    assert.deepEqual(page.problems, []);
}

test('traces what phat render traces: a mirror that shows panes, pictures and lights', (t) =>
    compare(t, mirror, 'rays', [81, 38, 101, 59]));

// Without the sky itself, which is the page's to draw.
const lowerHalf = [0, size.height / 2, size.width, size.height];

test('traces what phat render traces: metal under a sky with a sun', async (t) => {
    const sky = join(folder, 'sky.hdr'),
        picture = join(folder, 'yard.exr');
    await writeFile(sky, sunnySky());
    const file = await baked('yard', skyYard(), '20k', '--photons', '20k', '--environment', sky),
        page = await openPlugin(t, mesa.value, file);
    const flags = ['--size', `${size.width}x${size.height}`, '--spp', '1', '--quiet'];
    await phat('render', file, '-o', picture, '--trace', 'gpu', '--reflections', 'rays', ...flags);
    const expected = part((await readExr(picture)).pixels, lowerHalf, true);
    const drawn = (reflections) =>
        page.evaluate(
            async ([which, { width, height }]) => {
                const world = await load(true),
                    { light } = world,
                    target = new THREE.WebGLRenderTarget(width, height, { type: THREE.FloatType });
                Object.assign(light, { quality: 'default', reflections: which, reflectionMilliseconds: Infinity });
                if (which === 'rays') await light.loadTrees();
                renderer.setRenderTarget(target);
                renderer.render(world.scene, world.camera);
                const pixels = readTarget(target);
                renderer.setRenderTarget(null);
                light.dispose();
                target.dispose();
                return pixels;
            },
            [reflections, size],
        );
    const [traced, lookedUp] = [await drawn('rays'), await drawn('lookup')].map((all) => part(all, lowerHalf, true)),
        error = maeOverMean(traced, expected);
    t.diagnostic(`MAE/mean ${error.toFixed(5)}; of the lookup ${maeOverMean(lookedUp, expected).toFixed(5)}`);
    assert.ok(error < 0.01, `MAE/mean ${error}`);
    assert.ok(error < 0.1 * maeOverMean(lookedUp, expected));
});

for (const name of ['tabletop', 'gallery'])
    test(`traces what phat render traces: ${name}`, async (t) => {
        const { value: room, dispose } = await borrowRoom(name);
        t.after(dispose);
        await compare(t, room, 'auto');
    });

test('rays follow the materials of what they hit', async (t) => {
    // Whether the wall behind the eye, which the mirror shows, is changed before the first ray or after it.
    const edited = async (first) => {
        const page = await openAt(t, mirror.site);
        const before = first ? null : await tracedPixels(page);
        await page.evaluate(() => {
            viewer.scene.traverse(({ material }) => {
                if (!material?.map || material.alphaTest > 0) return;
                material.roughness = 0.2;
                material.metalness = 1;
                material.color.set(0.2, 0.9, 0.4);
            });
        });
        return { before, after: await tracedPixels(page) };
    };
    const late = await edited(false),
        early = await edited(true);
    assert.ok(maeOverMean(late.after, late.before) > 0.05, `${maeOverMean(late.after, late.before)}`);
    assert.ok(maeOverMean(late.after, early.after) < 1e-6, `${maeOverMean(late.after, early.after)}`);
});

// A copy of the site whose file `edit` has changed: its glTF, and what that says of the baked light.
async function editedSite(name, edit) {
    const site = join(folder, name);
    await cp(mirror.site, site, { recursive: true });
    const path = await partOf(site, 'room.glb'),
        bytes = await readFile(path),
        end = 20 + bytes.readUInt32LE(12),
        gltf = JSON.parse(bytes.subarray(20, end).toString());
    edit({ gltf, light: gltf.extensions.PHAT_photon_accumulation_texture });
    const text = JSON.stringify(gltf),
        json = Buffer.from(text.padEnd(text.length + (-Buffer.byteLength(text) & 3))),
        head = Buffer.from(bytes.subarray(0, 20));
    head.writeUInt32LE(bytes.length + json.length - (end - 20), 8);
    head.writeUInt32LE(json.length, 12);
    await writeFile(path, Buffer.concat([head, json, bytes.subarray(end)]));
    return site;
}

test('where there are no trees, or none that can be read, reflections are looked up', async (t) => {
    const damages = {
        missing: ({ light }) => delete light.bvh,
        short: ({ light }) => {
            light.bvh.nodes.byteLength -= 48;
        },
        swapped: ({ light }) => {
            light.bvh.order.bufferView = light.bvh.nodes.bufferView;
        },
        // The trees would be those of other triangles.
        opaque: ({ gltf }) => gltf.materials.forEach((material) => delete material.alphaMode),
    };
    for (const [name, edit] of Object.entries(damages)) {
        const page = await openAt(t, await editedSite(name, edit));
        const pixels = await tracedPixels(page);
        assert.deepEqual(
            await page.evaluate(() => [viewer.light.canTrace, viewer.light.isWhole, viewer.light.tracedMilliseconds]),
            [false, true, 0],
            name,
        );
        const expected = await pixelsOf(page, 4, 'default', 'lookup');
        assert.ok(maeOverMean(pixels, expected) < 1e-6, `${name}: ${maeOverMean(pixels, expected)}`);
        assert.deepEqual(page.problems, []);
    }
});

test('rays survive the loss of the context', async (t) => {
    const page = await openAt(t, mirror.site);
    const pixels = await tracedPixels(page);
    await loseContext(page);
    const again = await tracedPixels(page);
    assert.ok(maeOverMean(again, pixels) < 1e-6, `${maeOverMean(again, pixels)}`);
});

test("'auto' begins with the lookup, traces as time allows, and leaves nothing behind", async (t) => {
    const page = await openPlugin(t, mesa.value, mirror.file);
    const result = await page.evaluate(async () => {
        const world = await load(true),
            { light } = world,
            next = () => new Promise((done) => { setTimeout(done, 20); });
        const found = { lookedUp: draw(world) };
        Object.assign(light, { reflections: 'auto', reflectionMilliseconds: 1e6 });
        draw(world);
        found.first = light.tracedMilliseconds;
        found.readAtOnce = Boolean(light.bake.trees);
        for (let i = 0; i < 2000 && !(light.tracedMilliseconds > 0); ++i) {
            draw(world);
            await next();
        }
        found.then = light.tracedMilliseconds;
        found.isWhole = light.isWhole;
        found.traced = draw(world);
        light.reflectionMilliseconds = 0;
        found.slow = draw(world);
        found.atLast = light.tracedMilliseconds;
        light.dispose();
        found.left = countAlive();
        return found;
    });
    assert.equal(result.first, 0);
    assert.equal(result.readAtOnce, false);
    assert.ok(result.then > 0 && result.isWhole, `${result.then}`);
    assert.ok(maeOverMean(result.traced, result.lookedUp) > 0.01);
    assert.equal(result.atLast, 0);
    assert.ok(maeOverMean(result.slow, result.lookedUp) < 1e-6);
    const { Texture, ...others } = result.left;
    // three.js's own: of the pictures of the two materials that have some, three in all, and of the lamp.
    assert.ok(Texture <= 4, `${Texture}`);
    assert.deepEqual(new Set(Object.values(others)), new Set([0]));
    assert.ok(meanOf(result.traced) > 10);
});
