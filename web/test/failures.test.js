// What the page of `phat web` says where something fails on the way, and that it can be tried again.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { loaded, openRoom, viewport } from './site.js';

let browser, room, server, close;

before(async () => {
    ({ browser, room, server, close } = await openRoom());
});
after(() => close?.());

// A page whose requests for `glob` are answered by `answer(route)`.
async function openWith(t, { glob, answer, prepare, url = server.url }) {
    const page = await browser.newPage({ viewport });
    t.after(() => page.close());
    if (prepare) await page.addInitScript(prepare);
    if (glob) await page.route(glob, answer);
    await page.goto(url, { waitUntil: 'commit' });
    return page;
}

async function failureOf(page) {
    await page.waitForFunction(() => document.getElementById('message')?.hidden === false);
    assert.ok(await page.isVisible('#retry'), 'offers to retry');
    assert.ok(!(await page.isVisible('#loading')) && !(await page.isVisible('#unstarted')), 'says nothing else');
    return page.textContent('#message');
}

const html = { status: 200, contentType: 'text/html', body: '<!doctype html><title>Home</title>' };

test('says which part the server does not send, and why', async (t) => {
    for (const [glob, answer, expected] of [
        ['**/room.*.glb', { status: 404 }, /loaded: The server answers 404 Not Found for room\.\w+\.glb\.$/],
        ['**/room.lamps.*', { status: 503 }, /loaded: The server answers 503 Service Unavailable for room\.lamps\.\w+\.bin\.$/],
        ['**/room.*.glb', html, /The server sends a web page in place of room\.\w+\.glb\.$/],
        ['**/room.reflections.*', html, /The server sends a web page in place of room\.reflections\.\w+\.bin\.$/],
        ['**/room.*.glb', { status: 200, body: 'something else than a room' }, /What the server sends as room\.\w+\.glb is not a room\.$/],
    ]) {
        const page = await openWith(t, { glob, answer: (route) => route.fulfill(answer) });
        assert.match(await failureOf(page), expected);
    }
});

test('says that a server cannot be reached, and shows the room when it can again', async (t) => {
    const page = await openWith(t, { glob: '**/room.lamps.*', answer: (route) => route.abort('connectionrefused') });
    assert.match(await failureOf(page), /The server cannot be reached for room\.lamps\.\w+\.bin/);
    await page.unroute('**/room.lamps.*');
    await Promise.all([page.waitForNavigation(), page.click('#retry')]);
    await loaded(page);
    assert.equal(await page.isVisible('#retry'), false);
});

test('says what a browser lacks', async (t) => {
    const page = await openWith(t, {
        prepare: () => {
            delete globalThis.DecompressionStream;
        },
    });
    assert.match(await failureOf(page), /needs a newer browser, with DecompressionStream/);
});

test('says which script is missing or blocked', async (t) => {
    for (const [name, answer] of [
        ['viewer', (route) => route.fulfill({ status: 404 })],
        ['viewer', (route) => route.abort('blockedbyclient')],
        ['chunk', (route) => route.abort('blockedbyclient')],
    ]) {
        const page = await openWith(t, { glob: `**/${name}.*.js`, answer });
        assert.match(await failureOf(page), /The page's file (viewer|chunk)\.\w+\.js could not be loaded: it is missing on the server, or blocked\./);
    }
});

test('says so where a script cannot be parsed', async (t) => {
    const answer = (route) => route.fulfill({ contentType: 'text/javascript', body: 'let = of another century' });
    assert.match(await failureOf(await openWith(t, { glob: '**/chunk.*.js', answer })), /cannot run in this browser: .*SyntaxError/);
});

test('says so where no script runs at all', async (t) => {
    const page = await openWith(t, { glob: '**/*.js', answer: (route) => route.abort('blockedbyclient') });
    await page.waitForSelector('#unstarted', { state: 'visible' });
    assert.match(await page.textContent('#unstarted'), /scripts have not begun/);
});

test('says that browsers load no rooms from files', async (t) => {
    const page = await openWith(t, { url: `file://${join(room.site, 'index.html')}` });
    assert.match(await failureOf(page), /do not load a room from a file.*python3 -m http\.server/);
});
