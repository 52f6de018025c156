// The plug-in in a page of somebody else's.
import assert from 'node:assert/strict';
import { mkdtemp, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import validator from 'gltf-validator';
import { GlbBuilder } from './built_room.js';
import { maeOverMean, meanOf, partOf, phat, readExr } from './room.js';
import { openPluginRoom } from './site.js';

const repository = new URL('../../', import.meta.url).pathname;
let room, page, folder, close;

before(async () => {
    folder = await mkdtemp(join(tmpdir(), 'phat-files-'));
    ({ room, page, close } = await openPluginRoom(() => ({
        'test/baked.glb': join(folder, 'baked.glb'),
        'test/thing.glb': join(folder, 'thing.glb'),
    })));
});
after(async () => {
    await close?.();
    if (folder) await rm(folder, { recursive: true });
});

test('gltf-validator finds no error in what is baked and in what a page loads', async () => {
    const noteless = { maxIssues: 0 };
    const baked = await validator.validateBytes(new Uint8Array(await readFile(room.file)), noteless);
    assert.equal(baked.issues.numErrors, 0, JSON.stringify(baked.issues));
    const split = await validator.validateBytes(new Uint8Array(await readFile(await partOf(room.site, 'room.glb'))), {
        ...noteless,
        externalResourceFunction: async (uri) => new Uint8Array(await readFile(join(room.site, uri))),
    });
    assert.equal(split.issues.numErrors, 0, JSON.stringify(split.issues));
});

// What the loader's tests read is what a bake must carry along, whatever it is.
test('gltf-validator and three.js alone read what is baked from files of all sorts', async () => {
    const errorsOf = async (path) => {
        const { issues } = await validator.validateBytes(new Uint8Array(await readFile(path)), {
            maxIssues: 0,
        });
        return issues.numErrors;
    };
    const refused = [];
    const loaderFiles = await readdir(join(repository, 'tests/data/loader'));
    for (const name of [
        'scenes/cornell-glossy.glb',
        'scenes/gallery.glb',
        ...loaderFiles.filter((file) => file.endsWith('.glb')).map((file) => `tests/data/loader/${file}`),
    ]) {
        const input = join(repository, name),
            baked = join(folder, 'baked.glb');
        try {
            await phat('bake', input, '-o', baked, '--resolution', '8k', '--photons', '1k', '--probes', '64', '--quiet');
        } catch (error) {
            assert.match(error.stderr, /no triangles/);
            refused.push(name);
            continue;
        }
        // ClearCoatTest has an error of its own.
        const own = name.endsWith('ClearCoatTest.glb') ? await errorsOf(input) : 0;
        assert.equal(await errorsOf(baked), own, name);
        assert.ok((await page.evaluate((n) => meshesOf(`baked.glb?${n}`), name)) > 0, name);
    }
    assert.equal(refused.length, 2, refused.join());
});

test('lights what three.js alone leaves dark, and leaves no trace when it is detached', async () => {
    const { plain, lit, detached, used, left, maps } = await page.evaluate(async () => {
        const result = { plain: draw(await load(false)) };
        const world = await load(true);
        result.lit = draw(world);
        result.used = countAlive();
        world.light.detach();
        result.left = countAlive();
        result.detached = draw(world);
        // Textures that the passes had three.js upload stay three.js's.
        const maps = new Set();
        world.gltf.scene.traverse((o) => {
            if (o.material?.map) maps.add(o.material.map);
        });
        result.maps = maps.size;
        return result;
    });
    assert.ok(meanOf(lit) > 1.5 * meanOf(plain), `${meanOf(lit)} and ${meanOf(plain)}`);
    assert.ok(maeOverMean(detached, plain) < 1e-6);
    assert.ok(used.Texture > maps && used.Framebuffer > 0 && used.Program > 0);
    assert.deepEqual(left, {
        Texture: maps,
        Buffer: 0,
        Framebuffer: 0,
        VertexArray: 0,
        Program: 0,
        Shader: 0,
    });
});

test('moves with its object', async () => {
    const [still, moved] = await page.evaluate(async () => {
        const world = await load(true);
        const first = draw(world);
        // The camera is a part of the file: both move.
        world.gltf.scene.position.set(3, -1, 2);
        world.gltf.scene.rotation.set(0.2, 0.7, 0);
        world.gltf.scene.scale.setScalar(2);
        const second = draw(world);
        world.light.dispose();
        return [first, second];
    });
    // Texels and noise hang on rounded places: single pixels differ.
    assert.ok(maeOverMean(moved, still) < 0.01, `${maeOverMean(moved, still)}`);
});

test('follows materials, works with fog and tone mapping', async () => {
    const pictures = await page.evaluate(async () => {
        const world = await load(true),
            result = { baked: draw(world) };
        let top;
        world.gltf.scene.traverse((o) => {
            if (o.material?.name === 'table_top') top = o.material;
        });
        top.metalness = 0;
        result.plastic = draw(world);
        top.metalness = 1;
        // Normals that lean to one side.
        top.normalMap = new THREE.DataTexture(new Uint8Array([200, 128, 220, 255]), 1, 1);
        top.normalMap.needsUpdate = true;
        top.needsUpdate = true;
        result.mapped = draw(world);
        top.normalMap = null;
        top.needsUpdate = true;
        result.unmapped = draw(world);
        // Blended, but as opaque as before; then hardly to be seen.
        Object.assign(top, { transparent: true, needsUpdate: true });
        result.blended = draw(world);
        top.opacity = 0.1;
        result.faint = draw(world);
        Object.assign(top, { transparent: false, opacity: 1, needsUpdate: true });
        // A lamp of the page's own, beside the bake.
        const lamp = new THREE.PointLight(0xffffff, 5);
        lamp.position.set(0, 1.5, 0);
        world.scene.add(lamp);
        result.lamp = draw(world);
        world.scene.remove(lamp);
        renderer.toneMapping = THREE.AgXToneMapping;
        result.toneMapped = draw(world);
        renderer.toneMapping = THREE.NoToneMapping;
        world.scene.fog = new THREE.Fog(0x00ff00, 0, 0.01);
        world.gltf.scene.traverse((o) => {
            if (o.isMesh) o.material.needsUpdate = true;
        });
        result.fog = draw(world);
        world.light.dispose();
        return result;
    });
    const { baked, plastic, mapped, unmapped, blended, faint, lamp, toneMapped, fog } = pictures;
    assert.ok(maeOverMean(plastic, baked) > 0.02, 'metalness');
    assert.ok(maeOverMean(mapped, baked) > 0.01, 'normal map');
    assert.ok(maeOverMean(unmapped, baked) < 1e-6, 'without it again');
    assert.ok(maeOverMean(blended, baked) < 0.003, `blended: ${maeOverMean(blended, baked)}`);
    assert.ok(maeOverMean(faint, baked) > 0.03, `hardly there: ${maeOverMean(faint, baked)}`);
    assert.ok(meanOf(lamp) > 1.05 * meanOf(baked), 'a lamp');
    assert.ok(maeOverMean(toneMapped, baked) > 0.02, 'tone mapping');
    const middle = 4 * (160 * 45 + 80);
    assert.deepEqual(fog.slice(middle, middle + 3), [0, 255, 0]);
});

// A box before the camera, without gloss: three.js's is not glTF's.
function thingGlb() {
    const builder = new GlbBuilder();
    builder.json.extensionsUsed = ['KHR_materials_specular'];
    builder.push('materials', {
        pbrMetallicRoughness: { baseColorFactor: [0.8, 0.6, 0.4, 1], metallicFactor: 0, roughnessFactor: 1 },
        extensions: { KHR_materials_specular: { specularFactor: 0 } },
    });
    builder.add(0, [
        [[-0.4, 1.3, 0.9], [0, 0, 0.4], [0.4, 0, 0]],
        [[-0.4, 0.9, 1.3], [0.4, 0, 0], [0, 0.4, 0]],
        [[0, 0.9, 1.3], [0, 0, -0.4], [0, 0.4, 0]],
        [[-0.4, 0.9, 0.9], [0, 0, 0.4], [0, 0.4, 0]],
    ]);
    return builder.glb();
}

test('lights what is added as phat render does, and returns it to what it was', async () => {
    const thing = join(folder, 'thing.glb'),
        picture = join(folder, 'thing.exr');
    await writeFile(thing, thingGlb());
    const flags = ['--size', '160x90', '--spp', '1', '--quality', 'fast', '--reflections', 'lookup', '--quiet'];
    const drawn = async (...more) => {
        await phat('render', room.file, '-o', picture, ...flags, ...more);
        return (await readExr(picture)).pixels;
    };
    const want = await drawn('--with', thing),
        without = await drawn();
    const { added, removed, moved } = await page.evaluate(async () => {
        const world = await load(true),
            target = new THREE.WebGLRenderTarget(160, 90, { type: THREE.FloatType }),
            shot = () => {
                renderer.setRenderTarget(target);
                renderer.render(world.scene, world.camera);
                renderer.setRenderTarget(null);
                return readTarget(target);
            },
            result = {},
            box = await loadPlain('thing.glb');
        world.scene.children.find((o) => o.isAmbientLight).intensity = 0;
        world.scene.add(box);
        await world.light.add(box);
        result.added = shot();
        // It is lit where it is in the room, wherever the room is.
        for (const object of [world.gltf.scene, box]) {
            object.position.set(3, -1, 2);
            object.rotation.set(0, 0.7, 0);
            object.scale.setScalar(2);
        }
        result.moved = shot();
        world.light.remove(box);
        result.removed = shot();
        world.light.dispose();
        target.dispose();
        return result;
    });
    // The pixels that the box and its contact shadow change, but for those near edges.
    const shows = (i) => [0, 1, 2].some((c) => Math.abs(want[i + c] - without[i + c]) > 0.02 * without[i + c]);
    const inside = [],
        kBorder = 3;
    for (let y = kBorder; y < 90 - kBorder; ++y)
        for (let x = kBorder; x < 160 - kBorder; ++x) {
            let all = true;
            for (let dy = -kBorder; dy <= kBorder; ++dy)
                for (let dx = -kBorder; dx <= kBorder; ++dx) all &&= shows(4 * (160 * (y + dy) + x + dx));
            if (all) inside.push(4 * (160 * y + x));
        }
    assert.ok(inside.length > 200, `${inside.length} pixels`);
    // Edges between its faces lie elsewhere by SwiftShader: a row of pixels.
    const fractionOff = (pixels) => {
        const off = (i) => [0, 1, 2].some((c) => Math.abs(pixels[i + c] - want[i + c]) > 0.005 * want[i + c]);
        return inside.filter(off).length / inside.length;
    };
    assert.ok(fractionOff(added) < 0.05, `${fractionOff(added)}`);
    assert.ok(fractionOff(moved) < 0.05, `moved: ${fractionOff(moved)}`);
    // Its light and its shadow are gone: it is black, and the room as it is without it.
    const dark = inside.filter((i) => removed[i + 1] < 0.01 * want[i + 1]),
        bright = inside.filter((i) => Math.abs(removed[i + 1] - without[i + 1]) < 0.01 * without[i + 1]);
    assert.ok(dark.length > 200, `${dark.length} dark`);
    assert.ok(dark.length + bright.length > 0.95 * inside.length, `${bright.length} as without it, of ${inside.length}`);
});
