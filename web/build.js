// Builds dist/phatextures.js, the package, and dist/site/, the viewer that `phat web` puts beside a room.
import { build } from 'esbuild';
import { cp, readFile, rm, mkdir, writeFile } from 'node:fs/promises';
import { gzipSync } from 'node:zlib';

const here = new URL('.', import.meta.url).pathname;
const shaders = new URL('../shaders/', import.meta.url).pathname;

// The shaders that the browser needs; what they include comes along.
const roots = [
    'surface.vert',
    'fullscreen.vert',
    'depth.frag',
    'lobes.frag',
    'lookup.frag',
    'pool.frag',
    'display.frag',
    'preview.frag',
    'reflection_guides.frag',
    'trace_reflections.frag',
    'shade_reflections.frag',
    'trace_hit_lights.frag',
    'trace_lights.frag',
    'mean_reflections.frag',
    'pool_reflections.frag',
    'reproject_reflections.frag',
    'picture_cells.frag',
    'picture_alphas.frag',
    'split_sum.frag',
    'lib/probe_light.glsl',
    'present.frag',
    'accumulate.frag',
];

// Neither comments nor spaces are worth sending, but in directives, whose spaces count.
function strip(text) {
    const compact = (line) => (line.startsWith('#') ? line : line.replace(/ *([-+*\/<>=!&|?:;,(){}[\]]) */g, '$1'));
    return text
        .replace(/\/\/.*$/gm, '')
        .replace(/^\s+/gm, '')
        .replace(/[ \t]+$/gm, '')
        .split('\n')
        .map(compact)
        .join('\n');
}

async function shaderFiles() {
    const files = {};
    const add = async (name) => {
        if (name in files) return;
        files[name] = strip(await readFile(shaders + name, 'utf8'));
        for (const [, included] of files[name].matchAll(/^#include "(.*)"$/gm)) await add(included);
    };
    for (const root of roots) await add(root);
    return files;
}

const shaderPlugin = {
    name: 'shaders',
    setup(build) {
        build.onResolve({ filter: /^phat:shaders$/ }, () => ({ path: 'shaders', namespace: 'phat' }));
        build.onLoad({ filter: /.*/, namespace: 'phat' }, async () => ({
            contents: `export default ${JSON.stringify(await shaderFiles())}`,
        }));
    },
};

const common = {
    bundle: true,
    format: 'esm',
    target: 'es2022',
    plugins: [shaderPlugin],
    legalComments: 'none',
    absWorkingDir: here,
};

await rm(here + 'dist', { recursive: true, force: true });
await mkdir(here + 'dist/site', { recursive: true });
const {
    outputFiles: [own],
} = await build({
    ...common,
    entryPoints: ['viewer/viewer.js'],
    external: ['three'],
    minify: true,
    write: false,
});
await build({
    ...common,
    entryPoints: ['src/index.js'],
    outfile: 'dist/phatextures.js',
    external: ['three'],
});
await build({ ...common, entryPoints: ['viewer/viewer.js'], outfile: 'dist/site/viewer.js', minify: true });
for (const name of ['index.html', 'viewer.css'])
    await cp(`${here}viewer/${name}`, `${here}dist/site/${name}`);

// Gzipped, as web servers send it: all, and all but three.js.
const bundle = await readFile(here + 'dist/site/viewer.js');
const sizes = { bytes: bundle.length, gzip: gzipSync(bundle).length, ownGzip: gzipSync(own.contents).length };
await writeFile(here + 'dist/sizes.json', JSON.stringify(sizes) + '\n');
console.log(`viewer.js: ${sizes.bytes} bytes, ${sizes.gzip} gzipped, of which ours ${sizes.ownGzip}`);
