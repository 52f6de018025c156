// What `phat export --lightmap` writes, in three.js without the plug-in, beside the pictures of `phat render`.
import assert from 'node:assert/strict';
import { mkdtemp, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import validator from 'gltf-validator';
import { borrowBrowser, serve } from './browser.js';
import { lampRoom } from './lamp_room.js';
import { borrowRoom, maeOverMean, meanOf, phat, readExr } from './room.js';

let folder, mesa, tabletop, lamps;

before(async () => {
    folder = await mkdtemp(join(tmpdir(), 'phat-lightmap-'));
    [mesa, tabletop] = await Promise.all([borrowBrowser('gl-egl'), borrowRoom('tabletop')]);
    // Enough texels for the shadow of the plate in the light of the lamp at a point.
    lamps = join(folder, 'lamps.phat.glb');
    await writeFile(join(folder, 'lamps.glb'), lampRoom({ ceiling: 8, point: 6 }));
    await phat('bake', join(folder, 'lamps.glb'), '-o', lamps, '--resolution', '60k', '--photons', '50k', '--quiet');
});
after(async () => {
    await mesa?.dispose();
    await tabletop?.dispose();
    if (folder) await rm(folder, { recursive: true });
});

async function lightmapOf(file, ...options) {
    const path = await mkdtemp(join(folder, 'lightmap-'));
    await phat('export', file, '--lightmap', path, '--quiet', ...options);
    return path;
}

async function errorsOf(path) {
    const { issues } = await validator.validateBytes(new Uint8Array(await readFile(path)), { maxIssues: 0 });
    return issues.messages.filter(({ severity }) => severity === 0);
}

// The picture of three.js by the snippet of docs/lightmap.md.
async function drawn(t, path, direct) {
    const docs = await readFile(new URL('../../docs/lightmap.md', import.meta.url), 'utf8'),
        snippet = join(path, 'snippet.js');
    await writeFile(snippet, docs.match(/```js\n([^]*?)```/)[1]);
    const others = { 'test/lightmapped.js': snippet };
    for (const name of await readdir(path)) others[`test/lightmap/${name}`] = join(path, name);
    const server = await serve(new URL('..', import.meta.url).pathname, '/', others),
        page = await mesa.value.newPage();
    t.after(async () => {
        await page.close();
        server.close();
    });
    await page.goto(`${server.url}test/lightmap.html`);
    await page.waitForFunction(() => globalThis.ready);
    const result = await page.evaluate((options) => draw('lightmap/', options), { direct });
    assert.equal(result.error, 0);
    assert.equal(result.lit, result.meshes);
    return result;
}

async function rendered(file, component) {
    const picture = join(folder, `${component}.exr`);
    await phat(
        ...['render', file, '-o', picture, '--size', '160x90', '--component', component, '--quiet'],
        ...['--set', '*.specular=0', '*.metallic=0'],
    );
    return (await readExr(picture)).pixels;
}

async function compare(t, file, component, ...options) {
    const path = await lightmapOf(file, ...options),
        { scene } = JSON.parse(await readFile(join(path, 'lightmap.json'), 'utf8'));
    assert.deepEqual(await errorsOf(join(path, scene)), []);
    const result = await drawn(t, path, component === 'all'),
        expected = await rendered(file, component),
        error = maeOverMean(result.pixels, expected),
        bias = meanOf(result.pixels) / meanOf(expected) - 1;
    t.diagnostic(`MAE/mean ${error.toFixed(4)}, bias ${bias.toFixed(4)}`);
    assert.ok(error < 0.02, `MAE/mean ${error}`);
    assert.ok(Math.abs(bias) < 0.01, `bias ${bias}`);
    return { ...result, path };
}

test('indirect light is that of phat render', async (t) => {
    const { lights, path } = await compare(t, lamps, 'diffuse-indirect', '--light', 'indirect');
    assert.equal(lights, 1, path);
});

test('with area lights it is that of phat render: tabletop', (t) => compare(t, tabletop.value.file, 'all'));

test('so it is from several pages', async (t) => {
    const { path } = await compare(t, tabletop.value.file, 'all', '--page-size', '256');
    const { pages } = JSON.parse(await readFile(join(path, 'lightmap.json'), 'utf8'));
    assert.ok(pages.length > 2, `${pages.length}`);
});

test('with all lights it is that of phat render, and none is left in the file', async (t) => {
    const { lights } = await compare(t, lamps, 'all', '--light', 'all');
    assert.equal(lights, 0);
});
