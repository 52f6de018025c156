// Pages of `phat web`, opened and read.
import assert from 'node:assert/strict';
import { borrowBrowser, serve } from './browser.js';
import { borrowRoom } from './room.js';

export const viewport = { width: 160, height: 90 };

// A browser, a baked room, and a server of its site and `more` files, a function of the room. `close` gives them back.
export async function openRoom(name = 'tabletop', more = () => ({})) {
    const borrowed = await Promise.all([borrowBrowser('swiftshader'), borrowRoom(name)]),
        [browser, room] = borrowed.map(({ value }) => value),
        server = await serve(room.site, '/some/where/', more(room));
    const close = async () => {
        server.close();
        for (const { dispose } of borrowed) await dispose();
    };
    return { browser, room, server, close };
}

async function openPluginPage(browser, files) {
    const server = await serve(new URL('..', import.meta.url).pathname, '/', files),
        page = await browser.newPage();
    await page.goto(`${server.url}test/plugin.html`);
    await page.waitForFunction(() => globalThis.ready);
    return { server, page };
}

// plugin.html with the baked `file` as its room, until the test `t` ends.
export async function openPlugin(t, browser, file) {
    const { server, page } = await openPluginPage(browser, { 'test/room.phat.glb': file });
    t.after(async () => {
        await page.close();
        server.close();
    });
    return page;
}

// The same with the tabletop, for all tests of a file, and `more` files, a function of the room.
export async function openPluginRoom(more = () => ({})) {
    const borrowed = await Promise.all([borrowBrowser('swiftshader'), borrowRoom('tabletop')]),
        [browser, room] = borrowed.map(({ value }) => value),
        { server, page } = await openPluginPage(browser, { 'test/room.phat.glb': room.file, ...more(room) });
    const close = async () => {
        await page.close();
        server.close();
        for (const { dispose } of borrowed) await dispose();
    };
    return { browser, room, server, page, close };
}

// A page of `url` that notes what must not be. `prepare` runs in it first.
export async function open(browser, url, { prepare, size = viewport, query = '' } = {}) {
    const page = await browser.newPage({ viewport: size });
    page.problems = [];
    page.on('pageerror', (error) => page.problems.push(error.message));
    page.on('console', (message) => {
        if (message.type() === 'error') page.problems.push(message.text());
    });
    page.on('request', (request) => {
        if (!/^(blob|data):/.test(request.url()) && !request.url().startsWith(url))
            page.problems.push(request.url());
    });
    if (prepare) await page.addInitScript(prepare);
    await page.goto(url + query);
    return page;
}

// Resolves when the reflections are there, too.
export async function loaded(page) {
    await page.waitForFunction(() => document.getElementById('loading')?.hidden);
    assert.equal(await page.textContent('#message'), '');
    return page;
}

// Mean linear radiance of `count` pictures. Fast, because SwiftShader is slow. Whether the device would be fast enough for
// rays is not left to chance.
export async function pixelsOf(page, count = 1, quality = 'fast', reflections = 'lookup') {
    const bytes = await page.evaluate(
        ([n, q, r]) => {
            if (viewer.light) viewer.light.reflections = r;
            const data = new Uint8Array(viewer.render(n, q).buffer);
            let text = '';
            for (let i = 0; i < data.length; i += 8192)
                text += String.fromCharCode(...data.subarray(i, i + 8192));
            return btoa(text);
        },
        [count, quality, reflections],
    );
    return new Float32Array(new Uint8Array(Buffer.from(bytes, 'base64')).buffer);
}

export const rest = (page) =>
    page.evaluate(() => {
        viewer.renderer.setAnimationLoop(null);
    });

export const eyeOf = (page) => page.evaluate(() => viewer.camera.position.toArray());
export const forwardOf = (page) =>
    page.evaluate(() => viewer.camera.getWorldDirection(viewer.camera.position.clone()).toArray());
export const distance = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));
// Whether a movement is straight ahead, on the level.
export const isAlong = ([x, , z], [ahead, , deep], cosine) =>
    x * ahead + z * deep > cosine * Math.hypot(x, z) * Math.hypot(ahead, deep);

export async function drag(page, [fromX, fromY], [toX, toY]) {
    await page.mouse.move(fromX, fromY);
    await page.mouse.down();
    await page.mouse.move(toX, toY, { steps: 4 });
    await page.mouse.up();
}

// Of a page's view, which is restored then.
export async function loseContext(page) {
    await page.evaluate(async () => {
        const { canvas } = viewer,
            lose = viewer.renderer.getContext().getExtension('WEBGL_lose_context');
        const event = (name) =>
            new Promise((done) => {
                canvas.addEventListener(name, () => setTimeout(done), { once: true });
            });
        const lost = event('webglcontextlost'),
            restored = event('webglcontextrestored');
        lose.loseContext();
        await lost;
        lose.restoreContext();
        await restored;
    });
}
