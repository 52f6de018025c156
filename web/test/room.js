// Baked rooms and their pages, made by the program.
import { execFile } from 'node:child_process';
import { mkdtemp, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { promisify } from 'node:util';
import { FloatType } from 'three';
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js';
import { houseGlb } from './house.js';
import { lampRoom } from './lamp_room.js';
import { shared } from './shared.js';

const program = process.env.PHAT ?? new URL('../../build/dev/phat', import.meta.url).pathname;
const scenes = new URL('../../scenes/', import.meta.url).pathname;

// Of `phat web`: most of its time on a software driver is the poster's, which few tests look at.
export const smallPoster = ['--poster-width', '160'];

export async function phat(...args) {
    return (await promisify(execFile)(program, args)).stdout;
}

// A scene with every length times `factor`. A lamp at a point needs the square of it, to be as bright from so much
// farther away.
function scaledGlb(bytes, factor) {
    const end = 20 + bytes.readUInt32LE(12),
        gltf = JSON.parse(bytes.subarray(20, end).toString());
    const scene = gltf.scenes[gltf.scene ?? 0];
    gltf.nodes.push({ scale: [factor, factor, factor], children: scene.nodes });
    scene.nodes = [gltf.nodes.length - 1];
    for (const light of gltf.extensions?.KHR_lights_punctual?.lights ?? []) {
        if (light.type !== 'directional') light.intensity = (light.intensity ?? 1) * factor ** 2;
        if (light.range) light.range *= factor;
    }
    for (const { perspective } of gltf.cameras) {
        perspective.znear *= factor;
        if (perspective.zfar) perspective.zfar *= factor;
    }
    const text = JSON.stringify(gltf),
        json = Buffer.from(text.padEnd(text.length + (-Buffer.byteLength(text) & 3))),
        head = Buffer.from(bytes.subarray(0, 20));
    head.writeUInt32LE(bytes.length + json.length - (end - 20), 8);
    head.writeUInt32LE(json.length, 12);
    return Buffer.concat([head, json, bytes.subarray(end)]);
}

const made = { lamps: () => lampRoom({ ceiling: 8, point: 6 }), house: houseGlb };

// tabletop: area lights, a textured metal and diffuse things; gallery has a point light, too; lamps: both; house: two rooms and what is in a tour; these have few texels.
// Small, because SwiftShader draws it. 'lamps x 1000' is a thousand times as large.
async function makeRoom(name) {
    const [scene, factor = 1] = name.split(' x '),
        isMade = scene in made,
        bytes = isMade ? Buffer.from(made[scene]()) : await readFile(join(scenes, `${scene}.glb`));
    const folder = await mkdtemp(join(tmpdir(), 'phat-web-')),
        source = join(folder, `${scene}.glb`);
    await writeFile(source, factor === 1 ? bytes : scaledGlb(bytes, Number(factor)));
    const file = join(folder, `${scene}.phat.glb`),
        site = join(folder, 'site');
    await phat(
        'bake',
        source,
        '-o',
        file,
        '--resolution',
        isMade ? '8k' : '200k',
        '--photons',
        '100000',
        '--quiet',
    );
    const options = ['--title', 'A <table> & more', '--exposure', '1', ...(name === 'tabletop' ? [] : smallPoster)];
    await phat('web', file, '-o', site, ...options, '--quiet');
    return { folder, file, site };
}

// { value: { folder, file, site }, dispose } of a scene. The files are for all tests: nobody changes them.
export const borrowRoom = shared(makeRoom, ({ folder }) => rm(folder, { recursive: true }));

// The path of a file of a page, by its name without the hash.
export async function partOf(site, name) {
    const names = await readdir(site);
    return join(site, names.find((other) => other.replace(/\.[0-9a-f]{8}(?=\.\w+$)/, '') === name));
}

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
