// Pages of `phat web`, opened and read.
import assert from 'node:assert/strict';
import { launch, serve } from './browser.js';
import { makeRoom } from './room.js';

export const viewport = { width: 160, height: 90 };

// A browser, a baked room, and a server of its site. To be given back.
export async function openRoom() {
    const [browser, room] = await Promise.all([launch(), makeRoom()]);
    return { browser, room, server: await serve(room.site, '/some/where/') };
}

export async function closeRoom({ browser, room, server }) {
    await browser?.close();
    server?.close();
    await room?.dispose();
}

// A page of `url` that notes what must not be. `prepare` runs in it first.
export async function open(browser, url, { prepare, size = viewport } = {}) {
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
    await page.goto(url);
    return page;
}

// Resolves when the reflections are there, too.
export async function loaded(page) {
    await page.waitForFunction(() => document.getElementById('loading').hidden);
    assert.equal(await page.textContent('#message'), '');
    return page;
}

// Mean linear radiance of `count` pictures. Fast, because SwiftShader is slow.
export async function pixelsOf(page, count = 1, quality = 'fast') {
    const bytes = await page.evaluate(
        ([n, q]) => {
            const data = new Uint8Array(viewer.render(n, q).buffer);
            let text = '';
            for (let i = 0; i < data.length; i += 8192)
                text += String.fromCharCode(...data.subarray(i, i + 8192));
            return btoa(text);
        },
        [count, quality],
    );
    return new Float32Array(new Uint8Array(Buffer.from(bytes, 'base64')).buffer);
}

export const rest = (page) =>
    page.evaluate(() => {
        viewer.renderer.setAnimationLoop(null);
    });
