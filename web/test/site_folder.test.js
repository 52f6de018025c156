// The folder that `phat web` writes: what is in it, and what stays of what others have there. Needs no browser.
import assert from 'node:assert/strict';
import { copyFile, mkdir, mkdtemp, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { partOf, phat, smallPoster } from './room.js';

const scenes = new URL('../../scenes/', import.meta.url).pathname;
let folder, baked, other;

before(async () => {
    folder = await mkdtemp(join(tmpdir(), 'phat-folder-'));
    [baked, other] = ['baked.phat.glb', 'other.phat.glb'].map((name) => join(folder, name));
    for (const [file, seed] of [
        [baked, '1'],
        [other, '2'],
    ])
        await phat(
            ...['bake', join(scenes, 'cornell-glossy.glb'), '-o', file, '--resolution', '10k'],
            ...['--photons', '1k', '--seed', seed, '--quiet'],
        );
});
after(() => rm(folder, { recursive: true }));

const write = (file, site) => phat('web', file, '-o', site, ...smallPoster, '--quiet');

// A new folder with `files`, { name: text }.
async function folderOf(files) {
    const path = await mkdtemp(join(folder, 'site-'));
    for (const [name, text] of Object.entries(files)) await writeFile(join(path, name), text);
    return path;
}

// Names without hashes and texts of what is there.
async function contentsOf(path) {
    const entries = await readdir(path, { withFileTypes: true });
    const files = entries.filter((entry) => entry.isFile());
    return Object.fromEntries(
        await Promise.all(files.map(async ({ name }) => [name, await readFile(join(path, name), 'latin1')])),
    );
}

async function assertRefused(file, site, reason) {
    const before = await contentsOf(site);
    await assert.rejects(write(file, site), ({ code, stderr }) => {
        assert.equal(code, 1);
        assert.match(stderr, reason);
        assert.equal(stderr.trim().split('\n').length, 1, stderr);
        return true;
    });
    assert.deepEqual(await contentsOf(site), before, 'nothing is changed');
}

test("a folder with somebody else's files is refused", async () => {
    const site = await folderOf({ 'room.glb': 'precious', 'index.html': 'my page' });
    await assertRefused(baked, site, /site-\w+: has files in it that are not of a page/);
    await copyFile(baked, join(site, 'mine.phat.glb'));
    await assertRefused(join(site, 'mine.phat.glb'), site, /not of a page/);
    // Nor is it a page's because of a list of somebody else's.
    const listed = await folderOf({ 'phat-web.txt': 'my notes\nroom.glb\n', 'room.glb': 'precious' });
    await assertRefused(baked, listed, /not of a page/);
});

test('a file in place of the folder, and a folder in place of a file, are refused before the work', async () => {
    const file = join(folder, 'a file');
    await writeFile(file, 'text');
    await assert.rejects(write(baked, file), ({ code, stderr }) => code === 1 && /a file: is not a folder/.test(stderr));
    const site = await folderOf({});
    await write(baked, site);
    await rm(join(site, 'poster.jpg'));
    await mkdir(join(site, 'poster.jpg'));
    await assertRefused(baked, site, /poster.jpg: is a folder/);
});

test('a page replaces an older one, and keeps what others have put beside it', async () => {
    const site = await folderOf({});
    await write(baked, site);
    const first = await contentsOf(site);
    await writeFile(join(site, 'CNAME'), 'room.example');
    await mkdir(join(site, 'photographs'));
    await writeFile(join(site, 'photographs', 'a.jpg'), 'a picture');
    await writeFile(join(site, 'room.glb'), 'precious');
    await write(other, site);
    const second = await contentsOf(site);
    assert.equal(second.CNAME, 'room.example');
    assert.equal(second['room.glb'], 'precious');
    assert.equal(await readFile(join(site, 'photographs', 'a.jpg'), 'utf8'), 'a picture');
    // A cache that has the old parts is never asked for them: none has the name of a new one.
    const parts = (contents) => Object.keys(contents).filter((name) => /^room\.\w+.*\.(glb|bin)$/.test(name));
    assert.ok(parts(first).length >= 3, parts(first).join());
    assert.deepEqual(parts(first).filter((name) => parts(second).includes(name)), []);
    assert.equal(parts(first).length, parts(second).length);
    // The page itself asks for what is there now.
    for (const [, name] of second['index.html'].matchAll(/(?:src|href|data-room)="([^":?]+)["?]/g))
        assert.ok(name in second, name);
    for (const name of second['phat-web.txt'].split('\n').slice(1, -1)) assert.ok(name in second, name);
});

test('a page is not made of its own part, nor over what is not its own', async () => {
    const site = await folderOf({});
    await write(baked, site);
    await assertRefused(await partOf(site, 'room.glb'), site, /is a part of the page that would be replaced/);
    // Whoever edits the list says what is his.
    const list = join(site, 'phat-web.txt');
    await writeFile(list, (await readFile(list, 'utf8')).replace('LICENSE.txt\n', ''));
    await assertRefused(baked, site, /LICENSE.txt: is not a page's own/);
});

test('a list that names files elsewhere removes none of them', async () => {
    const site = await folderOf({});
    await write(baked, site);
    const list = join(site, 'phat-web.txt');
    await writeFile(join(folder, 'precious'), 'precious');
    await writeFile(list, `${await readFile(list, 'utf8')}../precious\n${join(folder, 'precious')}\n`);
    await write(baked, site);
    assert.equal(await readFile(join(folder, 'precious'), 'utf8'), 'precious');
});

test('the licences are there', async () => {
    const site = await folderOf({});
    await write(baked, site);
    const contents = await contentsOf(site);
    assert.match(contents['LICENSE.txt'], /The PHATextures authors/);
    assert.match(contents['THIRD_PARTY.txt'], /three\.js authors[^]*Permission is hereby granted/);
    const scripts = Object.entries(contents).filter(([name]) => name.startsWith('chunk.'));
    assert.equal(scripts.length, 1);
    assert.match(scripts[0][1], /Three\.js Authors\s*\*\s*SPDX-License-Identifier: MIT/);
});

test('a page says what it is told of itself, and where its poster is', async () => {
    const site = await folderOf({}),
        told = ['--url', 'https://example.org/room', '--description', 'Rooms <to> "let"'];
    await phat('web', baked, '-o', site, ...smallPoster, '--quiet', ...told);
    const page = await readFile(join(site, 'index.html'), 'utf8');
    assert.ok(page.includes('<meta property="og:image" content="https://example.org/room/poster.jpg">'));
    for (const name of ['name="description"', 'property="og:description"'])
        assert.ok(page.includes(`<meta ${name} content="Rooms &lt;to&gt; &quot;let&quot;">`), name);
    assert.ok(!page.includes('@'), 'all is filled in');
    await assert.rejects(
        phat('web', baked, '-o', site, '--quiet', '--url', 'javascript:alert(1)'),
        ({ code, stderr }) => code === 2 && /must begin with https/.test(stderr),
    );
});
