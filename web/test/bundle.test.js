// The package in a project of its own, installed as the README says and bundled. Needs no browser.
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { copyFile, cp, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { promisify } from 'node:util';
import { build } from 'esbuild';

const web = new URL('..', import.meta.url).pathname;

test('a bundle has one three.js', async (t) => {
    const project = await mkdtemp(join(tmpdir(), 'phat-project-'));
    t.after(() => rm(project, { recursive: true }));
    await writeFile(join(project, 'package.json'), JSON.stringify({ name: 'project', version: '1.0.0', type: 'module' }));
    await copyFile(join(web, 'examples/importmap/main.js'), join(project, 'main.js'));
    const readme = await readFile(join(web, '../README.md'), 'utf8'),
        [, flags] = readme.match(/`npm install ?(.*?) \.\/web`/);
    const install = ['install', '--offline', '--no-audit', '--no-fund', ...flags.split(' ').filter(Boolean)];
    // The project's own three.js, as from a registry, then the package.
    const three = join(project, 'registry/three');
    await cp(join(web, 'node_modules/three'), three, { recursive: true });
    for (const path of [three, web]) await promisify(execFile)('npm', [...install, path], { cwd: project });
    const { metafile } = await build({
        entryPoints: [join(project, 'main.js')],
        bundle: true,
        format: 'esm',
        write: false,
        metafile: true,
        outdir: project,
        absWorkingDir: project,
        logLevel: 'error',
    });
    const copies = Object.keys(metafile.inputs).filter((path) => path.endsWith('three.core.js'));
    assert.equal(copies.length, 1, copies.join());
});
