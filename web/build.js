// Builds dist/phatextures.js, the package, and dist/site/, the viewer that `phat web` puts beside a room.
import { build, transform } from 'esbuild';
import { createHash } from 'node:crypto';
import { readFile, rm, mkdir, writeFile } from 'node:fs/promises';
import { basename, join } from 'node:path';
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
    'present.frag',
    'accumulate.frag',
    'lib/photometry.glsl',
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
// Those that only light_updates.js needs beside these, and only added.js, which few rooms load.
const laterRoots = [
    'cover_texels.frag',
    'trace_probes.frag',
    'pack_probes.frag',
    'gather_guides.frag',
    'tabulate_guides.frag',
    'trace_texels.frag',
    'light_texels.frag',
    'pack_phatexels.frag',
    'estimate_irradiance.frag',
    'filter_irradiance.frag',
    'bound_tiles.frag',
];
const probeRoots = ['lib/probe_light.glsl'];

// Neither comments nor spaces are worth sending, but in directives, whose spaces count; nor zeros that say nothing.
function strip(text) {
    const shortest = (_, whole, part) => `${whole === '0' && /[1-9]/.test(part) ? '' : whole}.${part.replace(/0+$/, '')}`;
    const compact = (line) =>
        line.startsWith('#')
            ? line
            : line
                  .replace(/ *([-+*/<>=!&|?:;,(){}[\]]) */g, '$1')
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
                files = {
                    'phat:shaders': first,
                    'phat:ray-shaders': ofRays,
                    'phat:later-shaders': await shaderFiles(laterRoots, { ...first, ...ofRays }),
                    'phat:probe-shaders': await shaderFiles(probeRoots, first),
                };
            return { contents: `export default ${JSON.stringify(files[path])}` };
        });
    },
};

// Style sheets of shadow roots are text in the scripts.
const stylePlugin = {
    name: 'styles',
    setup(build) {
        build.onLoad({ filter: /\.css$/ }, async ({ path }) => {
            const { code } = await transform(await readFile(path, 'utf8'), { loader: 'css', minify: true });
            return { contents: code, loader: 'text' };
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
    plugins: [splitPlugin, shaderPlugin, stylePlugin],
    legalComments: 'eof',
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
    add(names.find((name) => /\/(viewer|begin)\./.test(name)));
    const contents = outputFiles.filter((_, i) => first.has(names[i])).map((file) => file.contents);
    const sum = (of) => contents.reduce((total, content) => total + of(content).length, 0);
    return { bytes: sum((content) => content), gzip: sum((content) => gzipSync(content)) };
}

const viewer = {
    ...common,
    entryPoints: { viewer: 'viewer/element.js' },
    outdir: 'dist/site',
    minify: true,
    write: false,
    // Named by their content, so that no cache mixes two versions.
    entryNames: '[name].[hash]',
    chunkNames: '[name].[hash]',
};

// The page, with the names of its files.
async function writePage(...builds) {
    const outputFiles = builds.flatMap((of) => of.outputFiles);
    const css = await readFile(here + 'viewer/viewer.css'),
        hash = createHash('sha256').update(css).digest('hex').slice(0, 8),
        files = [...outputFiles.map(({ path, contents }) => [basename(path), contents]), [`viewer.${hash}.css`, css]];
    let page = await readFile(here + 'viewer/index.html', 'utf8');
    for (const [name, contents] of files) {
        await writeFile(`${here}dist/site/${name}`, contents);
        page = page.replace(`"${name.replace(/\.\w+(?=\.\w+$)/, '')}"`, `"${name}"`);
    }
    await writeFile(here + 'dist/site/index.html', page);
    // By a name that stays, for the pages of others.
    const [entry] = files.map(([name]) => name).filter((name) => /^viewer\.\w+\.js$/.test(name));
    await writeFile(here + 'dist/site/phat-viewer.js', `import './${entry}';\n`);
}

// Our licence, and of what is in the scripts of others. The package takes three.js from its user.
async function writeLicenses() {
    const [own, three] = await Promise.all(
        ['../LICENSE', 'node_modules/three/LICENSE'].map((name) => readFile(here + name, 'utf8')),
    );
    const [ofPackage, ofSite] = [
        'The package contains parts of the shaders of three.js (https://threejs.org).',
        'The scripts contain three.js (https://threejs.org).',
    ].map((text) => `${text}\n\n${three}`);
    for (const [name, text] of [
        ['LICENSE', own], // where npm looks for it
        ['dist/THIRD_PARTY.txt', ofPackage],
        ['dist/site/LICENSE.txt', own],
        ['dist/site/THIRD_PARTY.txt', ofSite],
    ])
        await writeFile(here + name, text);
}

await rm(here + 'dist', { recursive: true, force: true });
await mkdir(here + 'dist/site', { recursive: true });
await build({
    ...common,
    entryPoints: { phatextures: 'src/index.js' },
    outdir: 'dist',
    external: ['three'],
    sourcemap: true,
});
const [own, site] = [await build({ ...viewer, external: ['three'] }), await build(viewer)];
// No module, since browsers load none from files.
const begin = await build({ ...viewer, entryPoints: { begin: 'viewer/begin.js' }, format: 'iife', splitting: false });
await writePage(site, begin);
await writeLicenses();

const sumOf = (a, b) => ({ bytes: a.bytes + b.bytes, gzip: a.gzip + b.gzip });
const sizes = { ...sumOf(sizeOf(site), sizeOf(begin)), ownGzip: sumOf(sizeOf(own), sizeOf(begin)).gzip };
await writeFile(here + 'dist/sizes.json', JSON.stringify(sizes) + '\n');
console.log(`the page's scripts: ${sizes.bytes} bytes, ${sizes.gzip} gzipped, of which ours ${sizes.ownGzip}`);
