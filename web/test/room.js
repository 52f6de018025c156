// Baked rooms and their pages, made by the program.
import { execFile } from 'node:child_process';
import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { promisify } from 'node:util';
import { FloatType } from 'three';
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js';
import { shared } from './shared.js';

const program = process.env.PHAT ?? new URL('../../build/dev/phat', import.meta.url).pathname;
const scenes = new URL('../../scenes/', import.meta.url).pathname;

export async function phat(...args) {
    return (await promisify(execFile)(program, args)).stdout;
}

// tabletop: area lights, a textured metal and diffuse things; gallery has a point light, too. Small, because
// SwiftShader draws it.
async function makeRoom(scene) {
    const folder = await mkdtemp(join(tmpdir(), 'phat-web-'));
    const file = join(folder, `${scene}.phat.glb`),
        site = join(folder, 'site');
    await phat(
        'bake',
        join(scenes, `${scene}.glb`),
        '-o',
        file,
        '--resolution',
        '200k',
        '--photons',
        '100000',
        '--quiet',
    );
    await phat('web', file, '-o', site, '--title', 'A <table> & more', '--exposure', '1', '--quiet');
    return { folder, file, site };
}

// { value: { folder, file, site }, dispose } of a scene. The files are for all tests: nobody changes them.
export const borrowRoom = shared(makeRoom, ({ folder }) => rm(folder, { recursive: true }));

// { width, height, pixels } as RGBA floats, row 0 at the bottom.
export async function readExr(path) {
    const loader = new EXRLoader();
    loader.type = FloatType;
    const bytes = await readFile(path);
    const { width, height, data } = loader.parse(
        bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length),
    );
    return { width, height, pixels: data };
}

export function meanOf(pixels) {
    let sum = 0;
    for (let i = 0; i < pixels.length; ++i) if (i % 4 < 3) sum += pixels[i];
    return sum / ((pixels.length * 3) / 4);
}

// mean |a - b| / mean b, as `phat compare` says it.
export function maeOverMean(a, b) {
    let sum = 0;
    for (let i = 0; i < b.length; ++i) if (i % 4 < 3) sum += Math.abs(a[i] - b[i]);
    return sum / ((b.length * 3) / 4) / meanOf(b);
}
