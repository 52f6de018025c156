// Bytes, times and errors of a page by `phat web` beside three.js alone, as JSON:
//   node web/bench/bench.js ROOM.phat.glb SITE REFERENCE.exr [WIDTH HEIGHT]
// REFERENCE: a linear picture of the room's camera, of that size (480 270).
import { readdir, stat } from 'node:fs/promises';
import { join, resolve } from 'node:path';
import { launch, serve } from '../test/browser.js';
import { maeOverMean, meanOf, readExr } from '../test/room.js';

const [room, site, referencePath, width = '480', height = '270'] = process.argv.slice(2);
const viewport = { width: Number(width), height: Number(height) };
const kSamples = 8,
    kFrames = 4;

const reference = (await readExr(referencePath)).pixels;

// relMSE as `phat compare` has it.
function relativeSquares(a, b) {
    const epsilon = 0.01 * meanOf(b) ** 2;
    let sum = 0;
    for (let i = 0; i < b.length; ++i) if (i % 4 < 3) sum += (a[i] - b[i]) ** 2 / (b[i] ** 2 + epsilon);
    return sum / ((b.length * 3) / 4);
}

async function measure(page, expression) {
    const text = await page.evaluate(
        ([code, samples]) => {
            const data = new Uint8Array((0, eval)(code)(samples).buffer);
            let all = '';
            for (let i = 0; i < data.length; i += 8192)
                all += String.fromCharCode(...data.subarray(i, i + 8192));
            return btoa(all);
        },
        [expression, kSamples],
    );
    const pixels = new Float32Array(new Uint8Array(Buffer.from(text, 'base64')).buffer);
    const frameMs = await page.evaluate(
        ([code, frames]) => {
            const start = performance.now();
            (0, eval)(code)(frames);
            return (performance.now() - start) / frames;
        },
        [expression, kFrames],
    );
    return {
        frameMs,
        maeOverMean: maeOverMean(pixels, reference),
        relMse: relativeSquares(pixels, reference),
        bias: meanOf(pixels) / meanOf(reference) - 1,
    };
}

const browser = await launch();
const result = { viewport };
{
    const server = await serve(resolve(site));
    const page = await browser.newPage({ viewport });
    const sizes = await Promise.all(
        (await readdir(site)).map(async (name) => [name, (await stat(join(site, name))).size]),
    );
    const start = performance.now();
    await page.goto(server.url);
    await page.waitForFunction(() => document.getElementById('poster').hidden, null, { timeout: 120_000 });
    const firstPictureMs = performance.now() - start;
    await page.waitForFunction(() => document.getElementById('loading').hidden, null, { timeout: 120_000 });
    const reflectionsMs = performance.now() - start;
    await page.evaluate(() => {
        viewer.renderer.setAnimationLoop(null);
    });
    result.phat = { bytes: Object.fromEntries(sizes), firstPictureMs, reflectionsMs };
    for (const quality of ['fast', 'default'])
        result.phat[quality] = await measure(page, `(n) => viewer.render(n, '${quality}')`);
    await page.close();
    server.close();
}
{
    const server = await serve(new URL('..', import.meta.url).pathname, '/', {
        'bench/room.phat.glb': resolve(room),
    });
    const page = await browser.newPage({ viewport });
    await page.goto(`${server.url}bench/peer.html`);
    await page.waitForFunction(() => globalThis.peer, null, { timeout: 120_000 });
    result.threeAlone = await measure(page, '(n) => peer.render(n)');
    await page.close();
    server.close();
}
await browser.close();
console.log(JSON.stringify(result, null, 2));
