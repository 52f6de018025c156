// What the page of `phat web` shows, beside the pictures of `phat render`.
import assert from 'node:assert/strict';
import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { borrowBrowser, serve } from './browser.js';
import { borrowRoom, maeOverMean, meanOf, phat, readExr, smallPoster } from './room.js';
import { measuredRoom } from './measured_room.js';
import { loaded, open, openRoom, pixelsOf, rest, viewport } from './site.js';
import { sunnyRoom } from './sunny_room.js';

let browser, room, server, close, mesa;

before(async () => {
    ({ browser, room, server, close } = await openRoom());
    mesa = await borrowBrowser('gl-egl'); // for all tests: it compiles a page's shaders for half a minute
});
after(async () => {
    await mesa?.dispose();
    await close?.();
});

// The samples and the shaders are the same. Half floats, the compiler's rounding and three.js's own filter of
// shadows are left; by SwiftShader, edges of triangles too, which it places on 1/16 of a pixel (Mesa: 1/64 or
// finer), and other levels of textures seen aslant. Both are errors of single pixels that more pixels make
// small: a lamp's narrow side that four samples of one pixel miss is .3 % of gallery's light at 160x90.
async function comparePictures(t, { file, folder, site }, angle, size) {
    const reference = join(folder, `reference${size.width}.exr`);
    const options = ['--spp', '4', '--reflections', 'lookup', '--quiet'];
    await phat('render', file, '-o', reference, '--size', `${size.width}x${size.height}`, ...options);
    const { width, height, pixels: expected } = await readExr(reference);
    assert.deepEqual({ width, height }, size);
    const { value: other, dispose } = await borrowBrowser(angle),
        served = await serve(site, '/some/where/');
    let page;
    t.after(async () => {
        await page?.close();
        await dispose();
        served.close();
    });
    page = await loaded(await open(other, served.url, { size }));
    await rest(page);
    const pixels = await pixelsOf(page, 4, 'default');
    const error = maeOverMean(pixels, expected),
        bias = meanOf(pixels) / meanOf(expected) - 1;
    t.diagnostic(`MAE/mean ${error.toFixed(5)}, bias ${bias.toFixed(5)}`);
    assert.ok(error < 0.01, `MAE/mean ${error}`);
    assert.equal(await page.evaluate(() => viewer.renderer.getContext().getError()), 0);
    assert.deepEqual(page.problems, []);
    return { pixels, expected };
}

for (const angle of ['gl-egl', 'swiftshader'])
    test(`draws what phat render draws: tabletop by ${angle}`, (t) =>
        comparePictures(t, room, angle, viewport));

test('draws what phat render draws: gallery by both', async (t) => {
    const { value: gallery, dispose } = await borrowRoom('gallery');
    t.after(dispose);
    const size = { width: 320, height: 180 };
    const { pixels, expected } = await comparePictures(t, gallery, 'gl-egl', size);
    // The lamp's highlight on the copper sphere, which is lit by three.js.
    const highlight = (all) =>
        all.filter((_, i) => {
            const x = (i / 4) % 320,
                y = 179 - Math.floor(i / 1280); // from the top
            return x >= 142 && x < 152 && y >= 64 && y < 78;
        });
    const bias = meanOf(highlight(pixels)) / meanOf(highlight(expected)) - 1;
    t.diagnostic(`bias of the highlight ${bias.toFixed(5)}`);
    assert.ok(Math.abs(bias) < 0.01, `highlight ${bias}`);
    await comparePictures(t, gallery, 'swiftshader', size);
});

// three.js's own light and its shadows have lengths, too.
for (const factor of [1000, 0.001])
    test(`draws what phat render draws: lamps ${factor} times as far away`, async (t) => {
        const { value: lamps, dispose } = await borrowRoom(`lamps x ${factor}`);
        t.after(dispose);
        await comparePictures(t, lamps, 'gl-egl', viewport);
    });

// Light that three.js draws, with its shadows: the sun's patch on the floor, the cones of a shade and of a spot.
test('draws what phat render draws: a sun through a window, a spot, and a pendant in a shade', async (t) => {
    const folder = await mkdtemp(join(tmpdir(), 'phat-sunny-'));
    t.after(() => rm(folder, { recursive: true }));
    const [scene, file, site] = ['scene.glb', 'room.phat.glb', 'site'].map((name) => join(folder, name));
    await writeFile(scene, sunnyRoom());
    await phat('bake', scene, '-o', file, '--resolution', '60k', '--photons', '50k', '--quiet');
    await phat('web', file, '-o', site, '--exposure', '0', ...smallPoster, '--quiet');
    await comparePictures(t, { file, folder, site }, 'gl-egl', { width: 320, height: 180 });
});

// Lamps that three.js does not know: one that washes walls on one side more than on others, one tilted downlight.
test('draws what phat render draws: lamps with photometry', async (t) => {
    const folder = await mkdtemp(join(tmpdir(), 'phat-photometry-'));
    t.after(() => rm(folder, { recursive: true }));
    const [scene, file, site] = ['scene.glb', 'room.phat.glb', 'site'].map((name) => join(folder, name));
    await writeFile(scene, measuredRoom());
    await phat('bake', scene, '-o', file, '--resolution', '60k', '--photons', '50k', '--quiet');
    await phat('web', file, '-o', site, '--exposure', '0', ...smallPoster, '--quiet');
    await comparePictures(t, { file, folder, site }, 'gl-egl', { width: 320, height: 180 });
});

test('is tone mapped as the poster is, at the exposure of its slider', async () => {
    const page = await loaded(await open(browser, server.url));
    await rest(page);
    const shown = (exposure) =>
        page.evaluate((stops) => {
            const slider = document.getElementById('room').find('exposure');
            slider.value = stops;
            viewer.render(4, 'default');
            slider.dispatchEvent(new Event('input'));
            viewer.present();
            const bytesOf = (picture) => {
                const copy = new OffscreenCanvas(160, 90).getContext('2d');
                copy.drawImage(picture, 0, 0, 160, 90);
                return [...copy.getImageData(0, 0, 160, 90).data];
            };
            return [viewer.canvas, document.getElementById('poster')].map(bytesOf);
        }, exposure);
    assert.equal(await page.inputValue('#exposure'), '1');
    const [picture, poster] = await shown(1),
        [darker] = await shown(0);
    // The poster is JPEG, and has six times as many pixels, whose noise is less.
    assert.ok(maeOverMean(picture, poster) < 0.03, `${maeOverMean(picture, poster)}`);
    assert.ok(Math.abs(meanOf(picture) / meanOf(poster) - 1) < 0.01, 'as bright');
    assert.ok(meanOf(darker) < 0.8 * meanOf(picture), 'a stop darker');
    await page.close();
});
