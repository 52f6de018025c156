// What rooms leave behind in a page that shows many, one after the other.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { openRoom, open } from './site.js';

const kRooms = 20,
    kFirst = 10; // in which the browser compiles what it runs often, and three.js fills what it keeps for good
let browser, server, close;

before(async () => {
    const bare = new URL('bare.html', import.meta.url).pathname;
    ({ browser, server, close } = await openRoom('lamps', (room) => ({ 'bare.html': bare, 'room.phat.glb': room.file })));
});
after(() => close?.());

// Contexts of WebGL that are drawn to, and what rooms consist of, as long as it is reachable.
function watch() {
    const contexts = (globalThis.contexts = []),
        { getContext } = HTMLCanvasElement.prototype;
    HTMLCanvasElement.prototype.getContext = function (...args) {
        const context = getContext.apply(this, args);
        contexts.push(new WeakRef(context));
        return context;
    };
    globalThis.parts = [];
    // When the room that an element begins to load is drawn, with all that there is of it: what three.js counts.
    globalThis.shown = async (element) => {
        await new Promise((done, fail) => {
            element.addEventListener('load', done, { once: true });
            element.addEventListener('error', ({ detail }) => fail(detail.sourceError), { once: true });
        });
        const { viewer } = element;
        viewer.light.reflections = 'lookup'; // to compile the programs of rays takes long
        await viewer.light.ready;
        while (!viewer.isWhole || viewer.picture.samples === 0) await new Promise((done) => setTimeout(done, 5));
        for (const part of [viewer, viewer.light, viewer.scene, viewer.renderer, viewer.light.bake.surfaces])
            globalThis.parts.push(new WeakRef(part));
        const { memory, programs } = viewer.renderer.info,
            { layers } = viewer.light.bake.lookup;
        const texelBytes = layers.reduce((sum, { texels }) => sum + texels.byteLength, 0);
        return { ...memory, programs: programs.length, texelBytes };
    };
}

// { heap bytes, parts, contexts } that are there once garbage is collected.
async function countHeld(page, client) {
    await client.send('HeapProfiler.collectGarbage');
    const { usedSize, backingStorageSize } = await client.send('Runtime.getHeapUsage');
    const held = await page.evaluate(() => ({
        parts: parts.filter((part) => part.deref()).length,
        contexts: contexts.filter((context) => context.deref()?.isContextLost() === false).length,
    }));
    return { bytes: usedSize + backingStorageSize, ...held };
}

// Shows so many rooms, each by `show(number)`, a function of the page that returns what three.js counts.
async function showMany(t, show) {
    const page = await open(browser, server.url, { prepare: watch, query: 'bare.html' }),
        client = await page.context().newCDPSession(page),
        counts = [];
    t.after(() => page.close());
    await page.waitForFunction(() => customElements.get('phat-viewer'));
    for (let i = 0; i < kRooms; ++i)
        counts.push({ ...(await page.evaluate(show, i)), ...(await countHeld(page, client)) });
    t.diagnostic(`${counts.map(({ bytes }) => (bytes / 1e6).toFixed(2)).join(' ')} MB, PHATexels ${counts[0].texelBytes / 1e6}`);
    assert.deepEqual(page.problems, []);
    return counts;
}

// `held`: parts and contexts. Of the heap, what the browser notes of each room's requests and compiles later on is less
// than half of the room's PHATexels.
function expectFlat(counts, held) {
    const [{ bytes: first, ...count }, ...rest] = counts.slice(kFirst);
    assert.deepEqual(count, { ...count, ...held });
    for (const { bytes, ...other } of rest) assert.deepEqual(other, count);
    const growth = (rest.at(-1).bytes - first) / rest.length;
    assert.ok(growth < count.texelBytes / 2, `${growth} bytes a room, of ${count.texelBytes}`);
}

test('twenty rooms in one element leave nothing behind', async (t) => {
    const counts = await showMany(t, (number) => {
        const element = document.querySelector('phat-viewer') ?? document.createElement('phat-viewer');
        if (!element.isConnected) document.body.append(element);
        element.src = `room.phat.glb?${number}`;
        return shown(element);
    });
    expectFlat(counts, { parts: 5, contexts: 1 });
});

test('twenty elements that are mounted and removed leave nothing behind', async (t) => {
    const counts = await showMany(t, async () => {
        const element = document.createElement('phat-viewer');
        Object.assign(element, { src: 'room.phat.glb', controls: true });
        document.body.append(element);
        const count = await shown(element);
        element.remove();
        return count;
    });
    expectFlat(counts, { parts: 0, contexts: 0 });
});
