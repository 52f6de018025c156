// Bytes, times and errors of the pages of `phat web` beside three.js alone: JSON, and on standard error a
// table. Errors are against tests/data/references. `make web-bench`, or
//   node web/bench/bench.js FOLDER [swiftshader | gl-egl]        FOLDER: of `make web-examples`
import { readdir, stat } from 'node:fs/promises';
import { join, resolve } from 'node:path';
import { launch, serve } from '../test/browser.js';
import { maeOverMean, meanOf, readExr } from '../test/room.js';

const [folder, angle = 'swiftshader'] = process.argv.slice(2);
const repository = new URL('../../', import.meta.url).pathname;
const viewport = { width: 480, height: 270 };
const kSamples = 8,
    kFrames = 4,
    kLong = { timeout: 300_000 };
// A middling line: 20 Mbit/s, 40 ms. Servers and browsers on it are those of the loopback.
const kThrottled = { offline: false, latency: 40, downloadThroughput: 20e6 / 8, uploadThroughput: 5e6 / 8 };

// relMSE as `phat compare` has it.
function relativeSquares(a, b) {
    const epsilon = 0.01 * meanOf(b) ** 2;
    let sum = 0;
    for (let i = 0; i < b.length; ++i) if (i % 4 < 3) sum += (a[i] - b[i]) ** 2 / (b[i] ** 2 + epsilon);
    return sum / ((b.length * 3) / 4);
}

function errorsOf(pixels, reference) {
    return {
        maeOverMean: maeOverMean(pixels, reference),
        relMse: relativeSquares(pixels, reference),
        bias: meanOf(pixels) / meanOf(reference) - 1,
    };
}

// `expression`: a function of the page that draws so many pictures and returns their mean.
async function measurePictures(page, expression, reference) {
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
    const isGlossy = (_, i) => reference.mask[i - (i % 4)] > 0.5;
    return {
        frameMs,
        whole: errorsOf(pixels, reference.pixels),
        glossy: errorsOf(pixels.filter(isGlossy), reference.pixels.filter(isGlossy)),
    };
}

// Opens a page and notes when each of the conditions, functions of the page by their names, has come true.
async function timeLoading(browser, url, conditions, network) {
    const page = await browser.newPage({ viewport });
    if (network) {
        const client = await page.context().newCDPSession(page);
        await client.send('Network.enable');
        await client.send('Network.emulateNetworkConditions', network);
    }
    const start = performance.now(),
        seconds = {};
    await page.goto(url, { waitUntil: 'commit' });
    for (const [name, condition] of Object.entries(conditions)) {
        await page.waitForFunction(condition, null, { ...kLong, polling: 20 });
        seconds[name] = (performance.now() - start) / 1000;
    }
    return { page, seconds };
}

async function timeBoth(browser, url, conditions) {
    const throttled = await timeLoading(browser, url, conditions, kThrottled);
    await throttled.page.close();
    const { page, seconds } = await timeLoading(browser, url, conditions);
    return { page, loopback: seconds, throttled: throttled.seconds };
}

async function measurePhat(browser, scene, reference) {
    const site = join(folder, scene),
        server = await serve(resolve(site));
    const bytes = await Promise.all(
        (await readdir(site)).map(async (name) => [name, (await stat(join(site, name))).size]),
    );
    const { page, ...times } = await timeBoth(browser, server.url, {
        poster: () => document.getElementById('poster')?.complete,
        firstPicture: () => globalThis.viewer?.picture.samples > 0,
        lampsToo: () => viewer.light.progress > 0,
        all: () => document.getElementById('loading').hidden,
    });
    await page.evaluate(() => viewer.renderer.setAnimationLoop(null));
    const result = { bytes: Object.fromEntries(bytes), ...times };
    for (const quality of ['fast', 'default'])
        result[quality] = await measurePictures(page, `(n) => viewer.render(n, '${quality}')`, reference);
    await page.close();
    server.close();
    return result;
}

async function measurePeer(browser, scene, reference, query = '') {
    const room = join(repository, `scenes/${scene}.glb`);
    const server = await serve(join(repository, 'web'), '/', { 'bench/room.glb': room });
    const { page, ...times } = await timeBoth(browser, `${server.url}bench/peer.html${query}`, {
        firstPicture: () => globalThis.peer,
    });
    const bytes = (await stat(room)).size;
    const result = { bytes, ...times, ...(await measurePictures(page, '(n) => peer.render(n)', reference)) };
    await page.close();
    server.close();
    return result;
}

const browser = await launch(angle),
    result = { viewport, angle };
for (const [scene, glossy] of [
    ['tabletop', 'table'],
    ['gallery', 'floor'],
]) {
    const [pixels, mask] = await Promise.all(
        [`${scene}-spec`, `${scene}.mask-${glossy}`].map(
            async (name) => (await readExr(join(repository, `tests/data/references/${name}.exr`))).pixels,
        ),
    );
    result[scene] = {
        phat: await measurePhat(browser, scene, { pixels, mask }),
        threeAlone: await measurePeer(browser, scene, { pixels, mask }),
        threeGrid: await measurePeer(browser, scene, { pixels, mask }, '?grid'),
    };
}
await browser.close();
console.log(JSON.stringify(result, null, 2));

const fixed = (x, digits) => x.toFixed(digits);
const errorCell = ({ maeOverMean: mae, relMse }) => `${fixed(mae, 3)}, ${relMse.toPrecision(2)}`;
const bothErrors = ({ whole, glossy }) => `${errorCell(whole)}; ${errorCell(glossy)}`;
const rows = [
    [
        'MB of the page; before the first picture',
        ({ phat: { bytes } }) => {
            const all = Object.values(bytes).reduce((sum, n) => sum + n);
            const first = Object.keys(bytes).filter((name) => /^(room\.\w+\.glb|(viewer|chunk)\..*js)$/.test(name)),
                before = first.reduce((sum, name) => sum + bytes[name], 0);
            return [all, before].map((n) => fixed(n / 1e6, 1)).join('; ');
        },
    ],
    ...['loopback', 'throttled'].map((network) => [
        `${network}, s: poster; first picture; area lights; all`,
        ({ phat }) =>
            Object.values(phat[network])
                .map((s) => fixed(s, 1))
                .join('; '),
    ]),
    [
        's a picture: fast; default',
        ({ phat }) => [phat.fast, phat.default].map(({ frameMs }) => fixed(frameMs / 1000, 1)).join('; '),
    ],
    ['MAE/mean, relMSE, default: whole; table or floor', ({ phat }) => bothErrors(phat.default)],
    ['the same, fast', ({ phat }) => bothErrors(phat.fast)],
    ...[
        ['three.js alone', 'threeAlone'],
        ['three.js with a grid of probes', 'threeGrid'],
    ].flatMap(([name, key]) => [
        [
            `${name}: MB; s loopback, throttled; s a picture`,
            ({ [key]: { bytes, loopback, throttled, frameMs } }) =>
                [
                    fixed(bytes / 1e6, 1),
                    `${fixed(loopback.firstPicture, 1)}, ${fixed(throttled.firstPicture, 1)}`,
                    fixed(frameMs / 1000, 2),
                ].join('; '),
        ],
        [`${name}: MAE/mean, relMSE`, ({ [key]: of }) => bothErrors(of)],
    ]),
];
console.error('| | tabletop | gallery |\n|---|---|---|');
for (const [name, cell] of rows)
    console.error(`| ${name} | ${cell(result.tabletop)} | ${cell(result.gallery)} |`);
