// The recipes of examples/, as their README files say, with the package's tarball and all else from npm's registry.
import assert from 'node:assert/strict';
import { cp, mkdir, mkdtemp, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { borrowBrowser, serve } from './browser.js';
import { borrowPacked, run } from './packed.js';
import { borrowRoom, maeOverMean } from './room.js';
import { viewport } from './site.js';

const examples = new URL('../examples/', import.meta.url).pathname;
let browser, room, tarball, borrowed, folder, unreachable, plain;

before(async () => {
    borrowed = await Promise.all([borrowBrowser('swiftshader'), borrowRoom('tabletop'), borrowPacked()]);
    [browser, room, { tarball }] = borrowed.map(({ value }) => value);
    folder = await mkdtemp(join(tmpdir(), 'phat-recipes-'));
    const ask = run('npm', ['view', 'three', 'version', '--prefer-online', '--fetch-retries=0', '--fetch-timeout=20000']);
    unreachable = await ask.then(
        () => false,
        ({ stderr }) => `npm's registry cannot be reached: ${stderr.split('\n')[0]}`,
    );
});
after(async () => {
    await rm(folder, { recursive: true });
    for (const { dispose } of borrowed) await dispose();
});

// A project of its own with what a recipe depends on, but for the package's version the tarball.
async function install(recipe, ...more) {
    const project = join(folder, recipe),
        manifest = join(project, 'package.json');
    await cp(join(examples, recipe), project, { recursive: true });
    const { version } = JSON.parse(await readFile(new URL('../package.json', import.meta.url), 'utf8')),
        text = await readFile(manifest, 'utf8'),
        dependency = `"phatextures": "${version}"`;
    assert.ok(text.includes(dependency));
    await writeFile(manifest, text.replace(dependency, `"phatextures": "file:${tarball}"`));
    await run('npm', ['install', '--no-audit', '--no-fund', ...more], { cwd: project });
    return project;
}

// Its page, and how many copies of three.js are in its scripts.
async function buildPage(project) {
    await mkdir(join(project, 'public'), { recursive: true });
    await cp(room.file, join(project, 'public/room.phat.glb'));
    await run('npm', ['run', 'build', '--', '--sourcemap'], { cwd: project });
    const page = join(project, 'dist'),
        assets = await readdir(join(page, 'assets')),
        copies = new Set();
    for (const name of assets.filter((asset) => asset.endsWith('.map'))) {
        const { sources } = JSON.parse(await readFile(join(page, 'assets', name), 'utf8'));
        for (const source of sources) if (source.endsWith('three.core.js')) copies.add(join(page, 'assets', source));
    }
    assert.equal(copies.size, 1, [...copies].join());
    return page;
}

// In the page: what its canvas shows, once that stays the same. Bytes, RGBA.
async function settledPicture() {
    const kSame = 3,
        kLit = 20, // mean of a byte
        kMaxMilliseconds = 600_000, // a guard against hanging
        // After the page's own callback, which asks for the next frame in its turn: later the canvas is cleared.
        frame = () => new Promise((done) => setTimeout(() => requestAnimationFrame(done)));
    for (let last = '', same = 0; performance.now() < kMaxMilliseconds; ) {
        await frame();
        const canvas = document.querySelector('canvas');
        if (!canvas?.width) continue;
        const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
        copy.drawImage(canvas, 0, 0);
        const bytes = [...copy.getImageData(0, 0, canvas.width, canvas.height).data],
            isLit = bytes.reduce((sum, byte, i) => sum + (i % 4 < 3 ? byte : 0), 0) > kLit * 0.75 * bytes.length;
        same = isLit && bytes.join() === last ? same + 1 : 0;
        last = bytes.join();
        if (same >= kSame) return bytes;
    }
    throw new Error('the canvas shows no room, or always another picture');
}

// What a page shows, and that nothing went wrong there.
async function pictureOf(t, site) {
    const server = await serve(site),
        page = await browser.newPage({ viewport }),
        problems = [];
    t.after(async () => {
        await page.close();
        server.close();
    });
    page.on('pageerror', ({ message }) => problems.push(message));
    page.on('console', (message) => {
        if (message.type() === 'error' && !message.location().url.endsWith('/favicon.ico')) problems.push(message.text());
    });
    await page.goto(server.url);
    const picture = await page.evaluate(settledPicture);
    assert.deepEqual(problems, []);
    return picture;
}

// A test of a recipe, skipped where there is no registry.
const recipe = (name, action) =>
    test(name, async (t) => {
        if (unreachable) t.skip(unreachable);
        else await action(t);
    });

// It depends on nothing else than three.js, which is here: this one is never skipped.
test('importmap: no bundler', async (t) => {
    const three = new URL('../node_modules/three', import.meta.url).pathname,
        project = await install('importmap', '--offline', '--install-links', three);
    await cp(room.file, join(project, 'room.phat.glb'));
    plain = await pictureOf(t, project);
});

// The same view, drawn by other hands: edges may be smoothed otherwise.
function assertLikePlain(picture, most) {
    const error = maeOverMean(picture, plain);
    assert.ok(error < most, `MAE/mean ${error}`);
}

recipe('vite: types, one three.js, the room', async (t) => {
    const project = await install('vite');
    await run('npm', ['run', 'check'], { cwd: project });
    assertLikePlain(await pictureOf(t, await buildPage(project)), 0.01);
});

recipe('react-three-fiber: strict mode, drei', async (t) => {
    const project = await install('react-three-fiber');
    assertLikePlain(await pictureOf(t, await buildPage(project)), 0.02);
});

recipe('postprocessing: bloom and tone mapping', async (t) => {
    const project = await install('postprocessing');
    assertLikePlain(await pictureOf(t, await buildPage(project)), 0.2);
});
