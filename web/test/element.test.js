// <phat-viewer> in pages of others: the configurator of the README, a frame, and its attributes, events and methods.
import assert from 'node:assert/strict';
import { cp, mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { borrowBrowser, serve } from './browser.js';
import { borrowRoom, maeOverMean, meanOf, phat, readExr } from './room.js';
import { open, pixelsOf, rest } from './site.js';

const size = { width: 176, height: 112 }; // of which the element is 160 x 90: 80 % of the height, between margins of 8
const example = new URL('../examples/configurator.html', import.meta.url).pathname,
    frame = new URL('frame.html', import.meta.url).pathname;
let browser, room, folder, server, page, borrowed;

// The configurator's page, whose viewer tests may use as `viewer`.
async function openExample() {
    const opened = await open(browser, server.url, { size });
    await opened.waitForFunction(() => globalThis.room?.loaded);
    await opened.evaluate(() => Object.assign(globalThis, { element: room, viewer: room.viewer }));
    return opened;
}

before(async () => {
    borrowed = await Promise.all([borrowBrowser('swiftshader'), borrowRoom('house')]);
    [browser, room] = borrowed.map(({ value }) => value);
    folder = await mkdtemp(join(tmpdir(), 'phat-element-'));
    await cp(room.site, join(folder, 'room-site'), { recursive: true });
    await cp(room.site, join(folder, 'site'), { recursive: true });
    const others = { 'room.phat.glb': room.file, 'frame.html': frame, 'favicon.ico': join(room.site, 'poster.jpg') };
    server = await serve(folder, '/', { 'index.html': example, ...others });
    page = await openExample();
    await page.evaluate(() => viewer.light.ready);
    await rest(page);
});
after(async () => {
    await page?.close();
    server?.close();
    for (const { dispose } of borrowed ?? []) await dispose();
    if (folder) await rm(folder, { recursive: true });
});

test('the README shows the configurator that is tested', async () => {
    const readme = await readFile(new URL('../../README.md', import.meta.url), 'utf8');
    assert.ok(readme.includes(await readFile(example, 'utf8')));
});

const press = (name) => page.click(`#choices button:has-text("${name}")`);

test('the configurator changes materials, which the light is then drawn with', async (t) => {
    assert.deepEqual(await page.$$eval('#choices button', (all) => all.map(({ textContent }) => textContent)), ['Oak', 'Lacquer']);
    const baked = await pixelsOf(page, 4);
    await page.evaluate(() => {
        globalThis.applied = [];
        room.addEventListener('variant-applied', ({ detail }) => applied.push(detail.name));
    });
    await press('Lacquer');
    await page.waitForFunction(() => applied.length === 1);
    const changed = await pixelsOf(page, 4, 'default');
    assert.ok(maeOverMean(changed, baked) > 0.05, `another picture: ${maeOverMean(changed, baked)}`);
    // As `phat render` draws these materials in the same light.
    const reference = join(folder, 'lacquer.exr'),
        sets = ['floor.baseColor=0.05,0.25,0.1', 'floor.roughness=0.15', 'table.baseColor=0.7,0.03,0.02', 'table.roughness=0.1'];
    await phat('render', room.file, '-o', reference, '--size', '160x90', '--spp', '4', '--reflections', 'lookup', '--quiet', ...sets.flatMap((set) => ['--set', set]));
    const { pixels } = await readExr(reference),
        error = maeOverMean(changed, pixels);
    t.diagnostic(`MAE/mean ${error.toFixed(4)}`);
    assert.ok(error < 0.01, `${error}`); // as of the materials of the bake: pictures.test.js
    await page.evaluate(() => (room.variantName = null));
    await page.waitForFunction(() => applied.length === 2);
    assert.ok(maeOverMean(await pixelsOf(page, 4), baked) < 1e-6, 'as it was');
    // A name that the file has not changes nothing.
    await page.evaluate(() => (room.variantName = 'Marble'));
    assert.ok(maeOverMean(await pixelsOf(page, 4), baked) < 1e-6);
    assert.deepEqual(await page.evaluate(() => applied), ['Lacquer', null]);
    await page.evaluate(() => (room.variantName = null));
    assert.deepEqual(page.problems, []);
});

test('a material is changed by its name', async () => {
    assert.ok((await page.evaluate(() => room.materials)).includes('table'));
    const before = await pixelsOf(page);
    const error = await page.evaluate(() => {
        room.setMaterial('table', { color: '#000080', roughness: 0.1 });
        try {
            room.setMaterial('chair', {});
        } catch ({ message }) {
            return message;
        }
    });
    assert.equal(error, 'the room has no material "chair"');
    assert.ok(maeOverMean(await pixelsOf(page), before) > 0.02);
});

test('attributes change the view and its brightness, and are followed later, too', async () => {
    const { poster, names, eye, moved, exposures, mode } = await page.evaluate(async () => {
        const result = { poster: room.shadowRoot.querySelector('img').src, names: room.viewpoints };
        room.setAttribute('camera', 'Kitchen'); // behind the wall: at once
        result.eye = viewer.camera.position.toArray();
        let told = 0;
        room.addEventListener('camera-change', () => ++told);
        room.camera = '-2 1.5 1 -2 1.5 0 50';
        room.jumpCameraToGoal();
        result.moved = [room.view, told > 0];
        room.exposure = 2;
        result.exposures = [room.getAttribute('exposure'), viewer.exposure];
        room.mode = 'orbit';
        result.mode = [viewer.navigation.mode];
        room.mode = '';
        result.mode.push(viewer.navigation.mode);
        return result;
    });
    assert.ok(poster.endsWith('/room-site/poster.jpg'));
    assert.deepEqual(names, ['Living room', 'Window', 'Kitchen']);
    assert.ok(Math.hypot(eye[0] - 2.4, eye[1] - 1.6, eye[2] - 1.5) < 1e-5, eye.join());
    assert.deepEqual(moved, ['-2,1.5,1;-2,1.5,0;50', true]);
    assert.deepEqual(exposures, ['2', 2]);
    assert.deepEqual(mode, ['orbit', 'walk']);
});

test('a blob is the picture that is shown', async () => {
    const { type, width, height, mean } = await page.evaluate(async () => {
        viewer.changed();
        const blob = await room.toBlob({ mimeType: 'image/jpeg', qualityArgument: 0.9 }),
            { width, height, ...image } = await createImageBitmap(blob).then((bitmap) => {
                const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
                context.drawImage(bitmap, 0, 0);
                const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
                return { width: bitmap.width, height: bitmap.height, mean: data.reduce((sum, x) => sum + x) / data.length };
            });
        return { type: blob.type, width, height, ...image };
    });
    assert.equal(type, 'image/jpeg');
    assert.ok(width > 0 && height > 0 && mean > 80, `${width}x${height}, mean ${mean}`); // 64: alpha alone
});

test('what is taken out of the document frees its context, and begins anew when it is put back', async () => {
    const { lost, isGone, events } = await page.evaluate(async () => {
        const context = viewer.renderer.getContext(),
            place = element.parentNode,
            seen = [];
        for (const name of ['progress', 'load', 'poster-dismissed']) element.addEventListener(name, () => seen.push(name));
        const afterwards = () => new Promise((done) => setTimeout(done));
        place.append(element); // moved, at once
        await afterwards();
        const stays = !context.isContextLost() && element.viewer === viewer;
        element.remove();
        await afterwards();
        const result = { lost: [stays, context.isContextLost()], isGone: element.viewer === null && !element.loaded };
        place.prepend(element);
        await new Promise((done) => element.addEventListener('poster-dismissed', done));
        return { ...result, events: [...new Set(seen)] };
    });
    assert.deepEqual(lost, [true, true]);
    assert.ok(isGone);
    assert.deepEqual(events, ['progress', 'load', 'poster-dismissed']);
    await page.evaluate(() => (globalThis.viewer = element.viewer));
    await rest(page);
    assert.ok(meanOf(await pixelsOf(page)) > 0.01);
});

test('a file that cannot be shown is an error event, and another source is shown then', async () => {
    const message = await page.evaluate(() => {
        const failed = new Promise((done) => room.addEventListener('error', ({ detail }) => done(detail.message), { once: true }));
        room.src = 'missing.glb';
        return failed;
    });
    assert.match(message, /could not be loaded: The server answers 404 Not Found for missing\.glb\.$/);
    assert.equal(await page.textContent('phat-viewer [part=message]'), message);
    await page.evaluate(() => {
        room.src = 'room.phat.glb';
        return new Promise((done) => room.addEventListener('load', done, { once: true }));
    });
    assert.ok(await page.isHidden('phat-viewer [part=message]'));
});

test('a page that frames a room is told what happens, and changes what it may', async () => {
    const framing = await open(browser, `${server.url}frame.html`, { size: { width: 600, height: 400 } });
    await framing.waitForFunction(() => told.some(({ event, detail }) => event === 'progress' && detail.totalProgress === 1));
    const first = await framing.evaluate(() => told.find(({ event }) => event === 'load').state);
    assert.deepEqual(first.availableVariants, ['Oak', 'Lacquer']);
    assert.deepEqual(first.viewpoints, ['Living room', 'Window', 'Kitchen']);
    const last = await framing.evaluate(async () => {
        const send = (phatViewer) => frame.contentWindow.postMessage({ phatViewer }, '*');
        const next = (name) =>
            new Promise((done) => {
                addEventListener('message', function hear({ data: { phatViewer } }) {
                    if (phatViewer?.event !== name) return;
                    removeEventListener('message', hear);
                    done(phatViewer);
                });
            });
        const applied = next('variant-applied');
        send({ set: { variantName: 'Lacquer', camera: 'Kitchen', exposure: 1, src: 'elsewhere.glb', innerHTML: 'x' } });
        const { state } = await applied,
            failed = next('error');
        send({ material: { name: 'chair' } });
        return { state, message: (await failed).detail.message, src: frame.contentDocument.getElementById('room').src };
    });
    assert.deepEqual(
        [last.state.variantName, last.state.camera, last.state.exposure, last.message],
        ['Lacquer', 'Kitchen', 1, 'the room has no material "chair"'],
    );
    assert.match(last.src, /^room\.\w+\.glb$/);
    await framing.close();
});
