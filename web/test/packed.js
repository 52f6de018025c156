// The package as npm would publish it.
import { execFile } from 'node:child_process';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { promisify } from 'node:util';
import { shared } from './shared.js';

const web = new URL('..', import.meta.url).pathname;
export const run = promisify(execFile);

async function pack() {
    const folder = await mkdtemp(join(tmpdir(), 'phat-npm-')),
        { stdout } = await run('npm', ['pack', '--json', '--pack-destination', folder], { cwd: web }),
        [about] = JSON.parse(stdout);
    return { folder, about, tarball: join(folder, about.filename) };
}

// { value: { about, tarball }, dispose }: what `npm pack` says of it, and its path.
export const borrowPacked = shared(pack, ({ folder }) => rm(folder, { recursive: true }));
