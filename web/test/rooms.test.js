// Glass in the page of `phat web`, beside the pictures of `phat render`.
import assert from 'node:assert/strict';
import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { borrowBrowser, serve } from './browser.js';
import { glassRoom } from './built_room.js';
import { maeOverMean, meanOf, phat, readExr, smallPoster } from './room.js';
import { distance, drag, eyeOf, forwardOf, isAlong, loaded, open, pixelsOf, rest, viewport } from './site.js';

const { width, height } = viewport;
let folder, served, mesa, page, pixels, expected;

before(async () => {
    folder = await mkdtemp(join(tmpdir(), 'phat-glass-'));
    const [scene, baked, site, reference] = ['room.glb', 'room.phat.glb', 'site', 'room.exr'].map((name) =>
        join(folder, name),
    );
    await writeFile(scene, glassRoom());
    await phat('bake', scene, '-o', baked, '--resolution', '60k', '--photons', '50k', '--quiet');
    await phat('web', baked, '-o', site, ...smallPoster, '--quiet');
    const options = ['--spp', '16', '--reflections', 'lookup', '--quiet', '--size', `${width}x${height}`];
    await phat('render', baked, '-o', reference, ...options);
    expected = (await readExr(reference)).pixels;
    mesa = await borrowBrowser('gl-egl');
    served = await serve(site);
    page = await loaded(await open(mesa.value, served.url));
    await rest(page);
    pixels = await pixelsOf(page, 16, 'default');
});
after(async () => {
    await page?.close();
    await mesa?.dispose();
    served?.close();
    if (folder) await rm(folder, { recursive: true });
});

// RGBA of the pixels where x and y, metres in the plane of the panes, are inside a rectangle.
function part(all, [left, bottom, right, top]) {
    const pixelsPerMeter = height / (2 * Math.tan(0.5) * 1.9);
    return all.filter((_, i) => {
        const x = (Math.floor(i / 4) % width) + 0.5 - width / 2,
            y = Math.floor(i / 4 / width) + 0.5 - height / 2;
        const at = [x / pixelsPerMeter, y / pixelsPerMeter + 1.4];
        return at[0] > left && at[0] < right && at[1] > bottom && at[1] < top;
    });
}

test('a transmission texture says where glass is opaque', (t) => {
    for (const [name, area] of [
        ['clear', [-1.25, 0.65, -0.75, 2.1]],
        ['opaque', [-0.65, 0.65, -0.15, 2.1]],
    ]) {
        const error = maeOverMean(part(pixels, area), part(expected, area));
        t.diagnostic(`${name}: MAE/mean ${error.toFixed(4)}`);
        // Glossy light on glass is the lookup's in the page, and the pyramid's in phat render: of 4 % of it.
        assert.ok(error < 0.03, `${name}: ${error}`);
    }
});

test('rough glass blurs what is behind it by its distance', (t) => {
    // Of blue strips before a white wall: a standard deviation over the mean.
    const contrast = (all, area) => {
        const reds = part(all, area).filter((_, i) => i % 4 === 0),
            mean = reds.reduce((a, b) => a + b) / reds.length;
        return Math.sqrt(reds.reduce((sum, x) => sum + (x - mean) ** 2, 0) / reds.length) / mean;
    };
    const contrasts = (area) => [pixels, expected].map((all) => contrast(all, area));
    const near = contrasts([0.3, 0.7, 1.2, 1.2]),
        far = contrasts([0.3, 1.55, 0.8, 1.75]);
    t.diagnostic(`contrasts, and of phat render: near ${near.join(' ')}, far ${far.join(' ')}`);
    // phat render takes 16 samples of the lobe where the page takes one that is filtered.
    assert.ok(Math.abs(near[0] / near[1] - 1) < 0.15, `near ${near}`);
    assert.ok(far[0] < 0.06 && far[1] < 0.06, `far ${far}`);
});

test('two nodes with one camera are two views', async () => {
    const names = await page.evaluate(() => document.getElementById('room').viewpoints),
        views = [];
    for (const [i, name] of names.entries()) {
        // The page is smaller here than its buttons need.
        const at = await page.evaluate((index) => {
            const room = document.getElementById('room'),
                camera = room.find('camera');
            camera.value = index;
            camera.dispatchEvent(new Event('change'));
            room.jumpCameraToGoal();
            return viewer.camera.position.toArray().map((x) => Math.round(1e4 * x) / 1e4);
        }, String(i));
        views.push([name, at]);
    }
    assert.deepEqual(views, [
        ['middle', [0, 1.4, 1.9]],
        ['aside', [1, 1.4, 1.9]],
    ]);
});

test('in a room the head turns, and the wheel walks', async () => {
    const [from, before] = [await eyeOf(page), await forwardOf(page)];
    await drag(page, [60, 45], [100, 50]);
    const turned = await forwardOf(page);
    assert.ok(distance(turned, before) > 0.2, 'the view has turned');
    assert.ok(before[2] * turned[0] - before[0] * turned[2] > 0, 'to the left, so that the room follows the pointer');
    assert.ok(distance(await eyeOf(page), from) < 0.01, 'the eye is where it was');
    await page.mouse.move(40, 60);
    await page.mouse.wheel(0, -300);
    await page.waitForFunction(
        ([x, y, z]) => viewer.camera.position.distanceTo({ x, y, z }) > 0.05,
        from,
    );
    const moved = (await eyeOf(page)).map((x, i) => x - from[i]);
    assert.ok(isAlong(moved, await forwardOf(page), 0.99), 'straight ahead');
    await page.evaluate(() => viewer.navigation.goTo(viewer.navigation.first));
});

const isInside = ([x, y, z]) => Math.abs(x) < 2 && y > 0 && y < 3 && Math.abs(z) < 2;

test('walls hold who walks, by keys and by the wheel', async () => {
    const walked = await page.evaluate(() => {
        const { navigation, camera } = viewer;
        navigation.pressed.add('s');
        for (let i = 0; i < 100; ++i) navigation.advance(0.02);
        navigation.pressed.clear();
        return camera.position.toArray();
    });
    assert.ok(isInside(walked) && walked[2] > 1.7, walked.join());
    await page.mouse.move(40, 60);
    for (let i = 0; i < 10; ++i) await page.mouse.wheel(0, 300);
    assert.ok(isInside(await eyeOf(page)));
    await page.evaluate(() => viewer.navigation.goTo(viewer.navigation.first));
});

test('who orbits stays in the room, and outside orbits the whole of it', async () => {
    const orbited = () =>
        page.evaluate(() => {
            const { navigation, camera } = viewer,
                places = [];
            for (const key of ['ArrowLeft', 'ArrowUp', 'ArrowDown', '-', 'q', 'e', 'd']) {
                navigation.pressed.add(key);
                for (let i = 0; i < 150; ++i) {
                    navigation.advance(0.02);
                    places.push(camera.position.toArray());
                }
                navigation.pressed.clear();
            }
            return places;
        });
    await page.evaluate(() => viewer.navigation.ask('orbit'));
    const inside = await orbited();
    assert.ok(inside.every(isInside), inside.find((place) => !isInside(place))?.join());
    const far = Math.max(...inside.map(([x]) => x)) - Math.min(...inside.map(([x]) => x));
    assert.ok(far > 1, `moves by ${far}`);
    await page.evaluate(() => {
        viewer.navigation.ask('');
        const outside = viewer.camera.clone();
        outside.position.set(0, 1.5, 8);
        outside.lookAt(0, 1.5, 0);
        outside.updateMatrixWorld();
        viewer.navigation.goTo(outside);
    });
    const from = await eyeOf(page);
    await drag(page, [60, 45], [100, 50]);
    assert.ok(distance(await eyeOf(page), from) > 0.1, 'the eye orbits');
    assert.equal(await page.evaluate(() => viewer.navigation.mode), 'orbit');
    await page.evaluate(() => viewer.navigation.goTo(viewer.cameras[0]));
});

// The page of a baked room, when it is at rest.
async function pageOf(t, name, room) {
    const [scene, baked, site] = [`${name}.glb`, `${name}.phat.glb`, name].map((file) => join(folder, file));
    await writeFile(scene, glassRoom(room));
    await phat('bake', scene, '-o', baked, '--resolution', '10k', '--photons', '10k', '--quiet');
    await phat('web', baked, '-o', site, ...smallPoster, '--quiet');
    const server = await serve(site);
    t.after(() => server.close());
    const other = await loaded(await open(mesa.value, server.url));
    await rest(other);
    return other;
}

// Pages show in perspective alone.
test('a room with parallel cameras alone is seen by a camera of the page', async (t) => {
    const other = await pageOf(t, 'parallel', { cameras: 'orthographic' });
    const eye = await eyeOf(other);
    assert.ok(eye.every((x, i) => x > [-2, 0, -2][i] && x < [2, 3, 2][i]), eye.join());
    assert.ok(meanOf(await pixelsOf(other)) > 0);
    await other.close();
});

test('walls keep the sun out, wherever its node is', async (t) => {
    const brightness = async (name, sun) => {
        const other = await pageOf(t, name, { sun });
        const seen = await pixelsOf(other);
        await other.close();
        return meanOf(seen);
    };
    const [dark, sunny] = [await brightness('night', 0), await brightness('day', 100)];
    t.diagnostic(`without the sun ${dark}, with it ${sunny}`);
    assert.ok(Math.abs(sunny / dark - 1) < 0.1, `${sunny} and ${dark}`);
});
