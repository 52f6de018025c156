// The recipes of examples/, as their README files say, with the package's tarball and all else from npm's registry.
import assert from 'node:assert/strict';
import { cp, mkdir, mkdtemp, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { borrowBrowser, serve } from './browser.js';
import { borrowPacked, run } from './packed.js';
import { borrowRoom, maeOverMean, meanOf } from './room.js';
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

// What a page shows once it stays the same: bytes, RGBA. Calls `meanwhile(page)` then, and looks again.
async function pictureOf(t, site, meanwhile) {
    const server = await serve(site),
        page = await browser.newPage({ viewport }),
        problems = [];
    t.after(async () => {
        await page.close();
        server.close();
    });
    page.on('pageerror', ({ message }) => problems.push(message));
    page.on('console', (message) => message.type() === 'error' && problems.push(message.text()));
    await page.goto(server.url);
    const settled = async () => {
        for (let [last, same] = ['', 0]; ; ) {
            const shot = (await page.screenshot()).toString('base64'),
                bytes = await page.evaluate(bytesOf, shot);
            same = shot === last && meanOf(bytes) > 20 ? same + 1 : 0;
            last = shot;
            if (same >= 4) return bytes;
            await page.waitForTimeout(250);
        }
    };
    let bytes = await settled();
    if (meanwhile) {
        await meanwhile(page);
        bytes = await settled();
    }
    if (process.env.PHAT_SHOTS) await page.screenshot({ path: join(process.env.PHAT_SHOTS, `${t.name}.png`) });
    assert.deepEqual(problems.filter((text) => !/favicon/.test(text)), []);
    return bytes;
}

async function bytesOf(shot) {
    const picture = new Image();
    picture.src = `data:image/png;base64,${shot}`;
    await picture.decode();
    const copy = new OffscreenCanvas(picture.width, picture.height).getContext('2d');
    copy.drawImage(picture, 0, 0);
    return [...copy.getImageData(0, 0, picture.width, picture.height).data];
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
