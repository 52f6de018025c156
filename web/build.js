// Builds dist/phatextures.js, the package, and dist/site/, the viewer that `phat web` puts beside a room.
import { build } from 'esbuild';
import { cp, readFile, rm, mkdir, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
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
    'split_sum.frag',
    'lib/probe_light.glsl',
    'present.frag',
    'accumulate.frag',
];
// Those that only ray_tracing.js needs, which slow devices don't load.
const rayRoots = [
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
];
// Those that only light_updates.js needs beside these, which few rooms load.
const laterRoots = [
    'gather_guides.frag',
    'tabulate_guides.frag',
    'trace_texels.frag',
    'light_texels.frag',
    'pack_phatexels.frag',
    'estimate_irradiance.frag',
    'filter_irradiance.frag',
];

// Neither comments nor spaces are worth sending, but in directives, whose spaces count; nor zeros that say nothing.
function strip(text) {
    const shortest = (_, whole, part) => `${whole === '0' && /[1-9]/.test(part) ? '' : whole}.${part.replace(/0+$/, '')}`;
    const compact = (line) =>
        line.startsWith('#')
            ? line
            : line
                  .replace(/ *([-+*\/<>=!&|?:;,(){}[\]]) */g, '$1')
                  .replace(/(?<![\w.])(\d+)\.(\d+)(?![\w.])/g, shortest);
    return text
        .replace(/\/\/.*$/gm, '')
        .replace(/^\s+/gm, '')
        .replace(/[ \t]+$/gm, '')
        .split('\n')
        .map(compact)
        .join('\n');
}

// The files of `of` with what they include, by their names, but those of `others`.
async function shaderFiles(of, others = {}) {
    const files = {};
    const add = async (name) => {
        if (name in files || name in others) return;
        files[name] = strip(await readFile(shaders + name, 'utf8'));
        for (const [, included] of files[name].matchAll(/^#include "(.*)"$/gm)) await add(included);
    };
    for (const root of of) await add(root);
    return files;
}

const shaderPlugin = {
    name: 'shaders',
    setup(build) {
        build.onResolve({ filter: /^phat:/ }, ({ path }) => ({ path, namespace: 'phat' }));
        build.onLoad({ filter: /.*/, namespace: 'phat' }, async ({ path }) => {
            const first = await shaderFiles(roots),
                ofRays = await shaderFiles(rayRoots, first),
                later = await shaderFiles(laterRoots, { ...first, ...ofRays }),
                files = { 'phat:shaders': first, 'phat:ray-shaders': ofRays, 'phat:later-shaders': later };
            return { contents: `export default ${JSON.stringify(files[path])}` };
        });
    },
};

// What is loaded on demand are files of their own. They import the entry point, so that all of the rest is in one file,
// chunk.js: else the names of what only some of it shares would be sent, too.
const splitPlugin = {
    name: 'split',
    setup(build) {
        const [entry] = Object.values(build.initialOptions.entryPoints),
            later = new Set();
        build.onResolve({ filter: /^phat:entry$/ }, () => ({ path: here + entry }));
        build.onResolve({ filter: /^\./ }, ({ path, kind, resolveDir }) => {
            if (kind === 'dynamic-import') later.add(join(resolveDir, path));
        });
        build.onLoad({ filter: /\.js$/ }, async ({ path }) =>
            later.has(path) ? { contents: `${await readFile(path, 'utf8')}import 'phat:entry';\n` } : null,
        );
    },
};


const common = {
    bundle: true,
    format: 'esm',
    target: 'es2022',
    plugins: [splitPlugin, shaderPlugin],
    legalComments: 'none',
    absWorkingDir: here,
    splitting: true,
    chunkNames: '[name]',
    metafile: true,
    logOverride: { 'ignored-bare-import': 'silent' }, // of splitPlugin: nothing is taken from the entry point
};

// Gzipped, as web servers send it, without what is loaded on demand.
function sizeOf({ outputFiles, metafile: { outputs } }) {
    const names = Object.keys(outputs),
        first = new Set();
    const add = (name) => {
        if (first.has(name) || !outputs[name]) return;
        first.add(name);
        for (const { path, kind } of outputs[name].imports) if (kind === 'import-statement') add(path);
    };
    add(names.find((name) => name.endsWith('viewer.js')));
    const contents = outputFiles.filter((_, i) => first.has(names[i])).map((file) => file.contents);
    const sum = (of) => contents.reduce((total, content) => total + of(content).length, 0);
    return { bytes: sum((content) => content), gzip: sum((content) => gzipSync(content)) };
}

const viewer = { ...common, entryPoints: ['viewer/viewer.js'], outdir: 'dist/site', minify: true, write: false };

await rm(here + 'dist', { recursive: true, force: true });
await mkdir(here + 'dist/site', { recursive: true });
await build({ ...common, entryPoints: { phatextures: 'src/index.js' }, outdir: 'dist', external: ['three'] });
const [own, site] = [await build({ ...viewer, external: ['three'] }), await build(viewer)];
for (const { path, contents } of site.outputFiles) await writeFile(path, contents);
for (const name of ['index.html', 'viewer.css'])
    await cp(`${here}viewer/${name}`, `${here}dist/site/${name}`);

const sizes = { ...sizeOf(site), ownGzip: sizeOf(own).gzip };
await writeFile(here + 'dist/sizes.json', JSON.stringify(sizes) + '\n');
console.log(`the page's scripts: ${sizes.bytes} bytes, ${sizes.gzip} gzipped, of which ours ${sizes.ownGzip}`);
