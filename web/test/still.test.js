// The picture of a view at rest on a slow device: drawn in parts, in all of the screen's pixels.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { borrowBrowser, serve } from './browser.js';
import { maeOverMean } from './room.js';
import { loaded, open, openRoom, pixelsOf, rest, viewport } from './site.js';

let room, server, browser, close;

before(async () => {
    ({ browser, room, server, close } = await openRoom());
});
after(() => close?.());

for (const angle of ['swiftshader', 'gl-egl'])
    test(`a picture in parts is the one drawn at once, bit for bit (${angle})`, async (t) => {
        const { value: other, dispose } = await borrowBrowser(angle),
            served = await serve(room.site);
        t.after(async () => {
            await dispose();
            served.close();
        });
        const page = await loaded(await open(other, served.url));
        await rest(page);
        const { different, parts, mean } = await page.evaluate(() => {
            const { still, light } = viewer,
                kSamples = 2,
                kPlanned = 8; // samples that the jitter is for
            viewer.setScale(1);
            viewer.quality = 'default';
            Object.assign(light, { waitsForPrograms: true, reflections: 'lookup' });
            viewer.changed();
            for (let i = 0; i < kSamples; ++i) viewer.addSample('default', kPlanned);
            const whole = viewer.picture.read();
            still.rows = 16; // whatever it has learned
            let count = 0;
            for (; still.picture.samples < kSamples; ++count) still.advance();
            const inParts = still.picture.read();
            return {
                different: whole.filter((x, i) => x !== inParts[i]).length,
                mean: whole.reduce((sum, x) => sum + x) / whole.length,
                parts: count,
            };
        });
        await page.close();
        assert.ok(parts >= 8 && mean > 0.01, `${parts} parts, mean ${mean}`);
        assert.equal(different, 0);
    });

// A script of a page: on a device that takes a second for some pixels, from the viewer's first picture on, which `change`
// has changed before.
const onSlowDevice = (change) => `{
    let slowed;
    Object.defineProperty(globalThis, 'viewer', {
        get: () => slowed,
        set: (viewer) => {
            slowed = viewer;
            Object.defineProperty(viewer, 'secondsPerPixel', { get: () => 1e-3, set: () => {} });
            (${change})(viewer);
        },
    });
}`;

function noteSizes(viewer) {
    globalThis.sizes = [];
    const { present } = viewer;
    viewer.present = () => {
        present.call(viewer);
        globalThis.sizes.push(viewer.canvas.width);
    };
}

// That does not come to draw any part.
function holdParts({ still }) {
    still.advance = () => 0;
}

test('a slow device keeps the poster until a picture of all pixels is there', async () => {
    const page = await open(browser, server.url, { prepare: onSlowDevice(noteSizes), query: '?quality=fast' });
    await page.waitForFunction(() => globalThis.viewer?.picture.samples > 0);
    const shown = await page.evaluate(
        () =>
            new Promise((done) => {
                const poster = document.getElementById('poster'),
                    look = () => done({ samples: viewer.still.picture.samples, sizes: globalThis.sizes });
                if (poster.hidden) look();
                else new MutationObserver(look).observe(poster, { attributes: true });
            }),
    );
    // Coarse ones under the poster, then some of all pixels, whose mean has smooth edges.
    const { width } = viewport;
    assert.equal(shown.sizes[0], width / 4);
    assert.ok(shown.samples >= 4, `${shown.samples} samples`);
    assert.deepEqual(shown.sizes.slice(-4), Array(4).fill(width));
    await page.waitForFunction(() => viewer.still.isDone);
    await rest(page);
    const [still, atOnce] = await Promise.all([
        page.evaluate(() => [...viewer.still.picture.read()]),
        pixelsOf(page, 8, 'fast'),
    ]);
    assert.ok(maeOverMean(still, atOnce) < 1e-6, `${maeOverMean(still, atOnce)}`);
    assert.deepEqual(page.problems, []);
    await page.close();
});

test('what the visitor does is drawn at once, as coarse as it is', async () => {
    const page = await open(browser, server.url, { prepare: onSlowDevice(holdParts) });
    await page.waitForFunction(() => globalThis.viewer?.light.isWhole && viewer.still.isDue);
    assert.equal(await page.isVisible('#poster'), true);
    await page.mouse.move(80, 45);
    await page.mouse.down();
    await page.waitForFunction(() => document.getElementById('poster').hidden);
    await page.close();
});

test('?quality= chooses the quality', async () => {
    for (const [query, expected] of [
        ['?quality=fast', 'fast'],
        ['?quality=high', 'high'],
        ['?quality=best', 'default'],
        ['', 'default'],
    ]) {
        const page = await open(browser, server.url, { query });
        await page.waitForFunction(() => document.getElementById('room').ui);
        const chosen = await page.evaluate(() => [viewer.quality, document.getElementById('room').find('quality').value]);
        assert.deepEqual(chosen, [expected, expected], query);
        await page.close();
    }
});
