// The plug-in in projects as they are: clones, instances, materials of their own, rooms that are unmounted and mounted again,
// other renderers.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { maeOverMean, meanOf } from './room.js';
import { openPluginRoom } from './site.js';

let page, close;

before(async () => {
    ({ page, close } = await openPluginRoom());
    await page.evaluate(async () => {
        globalThis.meshesOfRoom = ({ gltf }) => {
            const meshes = [];
            gltf.scene.traverse((o) => o.isMesh && meshes.push(o));
            return meshes;
        };
        // A renderer of its own for `action`, of the canvas that plugin.html's has.
        globalThis.withRenderer = (options, action) => {
            const other = new THREE.WebGLRenderer({ antialias: false, preserveDrawingBuffer: true, ...options });
            other.setSize(160, 90);
            try {
                return action(other);
            } finally {
                other.dispose();
                other.forceContextLoss();
            }
        };
        globalThis.drawBy = (other, { scene, camera }) => {
            other.render(scene, camera);
            return readCanvas(other);
        };
    });
});
after(() => close?.());

// Texels and noise hang on rounded places: single pixels differ where a room is elsewhere.
const kMoved = 0.01;

test('clones of a room show its light, wherever they are, with it or alone', async () => {
    const { still, own, alone, turned, turnedAlone, both } = await page.evaluate(async () => {
        const world = await load(true),
            { scene, camera, gltf } = world,
            result = { still: draw(world) };
        const clone = gltf.scene.clone();
        clone.position.set(5, 1, -2);
        clone.rotation.set(0, 0.5, 0);
        clone.updateMatrixWorld(true);
        const eyeFrom = (matrix) => {
            const moved = camera.clone();
            camera.matrixWorld.clone().premultiply(matrix).decompose(moved.position, moved.quaternion, moved.scale);
            return moved;
        };
        scene.add(clone);
        result.own = draw(world); // the clone is behind the room, if in view at all
        result.both = draw({ scene, camera: eyeFrom(clone.matrixWorld) });
        scene.remove(gltf.scene);
        result.alone = draw({ scene, camera: eyeFrom(clone.matrixWorld) });
        // Another view: no old picture.
        const tilt = new THREE.Matrix4().makeRotationY(0.15);
        result.turnedAlone = draw({ scene, camera: eyeFrom(clone.matrixWorld.clone().multiply(tilt)) });
        scene.remove(clone);
        scene.add(gltf.scene);
        result.turned = draw({ scene, camera: eyeFrom(tilt) });
        world.light.detach();
        return result;
    });
    assert.ok(maeOverMean(turned, still) > 0.1, 'another view is another picture');
    assert.ok(maeOverMean(alone, still) < kMoved, `alone: ${maeOverMean(alone, still)}`);
    assert.ok(maeOverMean(turnedAlone, turned) < kMoved, `turned: ${maeOverMean(turnedAlone, turned)}`);
    assert.ok(maeOverMean(both, still) < kMoved, `beside the room: ${maeOverMean(both, still)}`);
    assert.ok(maeOverMean(own, still) < kMoved, `the room beside it: ${maeOverMean(own, still)}`);
});

// drei 10.7's <Clone> makes new objects of the same types with these properties; React Three Fiber copies those that are
// vectors, and frees nothing of them where it is unmounted.
test("what drei's <Clone> makes shows the light, and only what is adopted where it has materials of its own", async () => {
    const { still, alone, deep, adopted, unmounted } = await page.evaluate(async () => {
        const world = await load(true),
            { scene, camera, gltf, light } = world,
            result = { still: draw(world) };
        const keys = ['castShadow', 'receiveShadow', 'visible', 'name', 'geometry', 'material', 'position', 'rotation', 'scale', 'up', 'userData'];
        const cloneOf = (object, copyMaterials) => {
            const made = new THREE[object.type]();
            for (const key of keys) {
                if (made[key]?.set && made[key].copy) made[key].copy(object[key]);
                else if (object[key] !== undefined) made[key] = object[key];
            }
            if (copyMaterials && made.material) made.material = made.material.clone();
            made.add(...object.children.map((child) => cloneOf(child, copyMaterials)));
            return made;
        };
        const drawMoved = (clone) => {
            scene.add(clone);
            clone.position.set(5, 1, -2);
            clone.rotation.set(0, 0.5, 0);
            clone.updateMatrixWorld(true);
            const moved = camera.clone();
            camera.matrixWorld.clone().premultiply(clone.matrixWorld).decompose(moved.position, moved.quaternion, moved.scale);
            return draw({ scene, camera: moved });
        };
        const shared = cloneOf(gltf.scene, false),
            own = cloneOf(gltf.scene, true);
        scene.remove(gltf.scene);
        result.alone = drawMoved(shared);
        scene.remove(shared);
        result.deep = drawMoved(own);
        own.traverse(({ material }) => material && light.adopt(material));
        result.adopted = drawMoved(own);
        scene.remove(own);
        scene.add(gltf.scene);
        result.unmounted = draw(world);
        light.detach();
        return result;
    });
    assert.ok(maeOverMean(alone, still) < kMoved, `${maeOverMean(alone, still)}`);
    assert.ok(meanOf(deep) < 0.8 * meanOf(still), 'deep="materialsOnly"');
    assert.ok(maeOverMean(adopted, still) < kMoved, `adopted: ${maeOverMean(adopted, still)}`);
    assert.ok(maeOverMean(unmounted, still) < 1e-6, `${maeOverMean(unmounted, still)}`);
});

test('instances of a part show the light that it has', async () => {
    const { still, instanced, moved, movedSingle } = await page.evaluate(async () => {
        const world = await load(true),
            { scene } = world;
        const part = meshesOfRoom(world).find((mesh) => /crate|globe|cone/.test(mesh.name + mesh.material.name));
        const result = { still: draw(world) };
        part.visible = false;
        const instances = new THREE.InstancedMesh(part.geometry, part.material, 2);
        instances.name = part.name;
        instances.frustumCulled = false;
        instances.setMatrixAt(0, new THREE.Matrix4());
        instances.setMatrixAt(1, new THREE.Matrix4().makeTranslation(0, 100, 0)); // out of view
        part.matrixWorld.decompose(instances.position, instances.quaternion, instances.scale);
        scene.add(instances);
        result.instanced = draw(world);
        const shift = new THREE.Matrix4().makeTranslation(0, 0.2, 0);
        instances.setMatrixAt(0, shift);
        instances.instanceMatrix.needsUpdate = true;
        result.moved = draw(world);
        // The same by a clone of the mesh.
        scene.remove(instances);
        const single = part.clone();
        part.matrixWorld.clone().multiply(shift).decompose(single.position, single.quaternion, single.scale);
        single.visible = true;
        scene.add(single);
        result.movedSingle = draw(world);
        world.light.detach();
        return result;
    });
    assert.ok(maeOverMean(instanced, still) < kMoved, `${maeOverMean(instanced, still)}`);
    assert.ok(maeOverMean(moved, still) > 2 * kMoved, 'it has moved');
    assert.ok(maeOverMean(movedSingle, moved) < kMoved, `a clone: ${maeOverMean(movedSingle, moved)}`);
});

test('a material in place of the baked one shows the light once it is adopted', async () => {
    const { still, replaced, adopted, refusal } = await page.evaluate(async () => {
        const world = await load(true),
            result = { still: draw(world) };
        const copies = new Map();
        for (const mesh of meshesOfRoom(world)) {
            if (!copies.has(mesh.material)) copies.set(mesh.material, mesh.material.clone());
            mesh.material = copies.get(mesh.material);
        }
        result.replaced = draw(world);
        copies.forEach((material) => world.light.adopt(material));
        result.adopted = draw(world);
        try {
            world.light.adopt(new THREE.MeshToonMaterial());
        } catch ({ message }) {
            result.refusal = message;
        }
        world.light.detach();
        return result;
    });
    assert.ok(maeOverMean(replaced, still) > 0.2, 'by three.js alone');
    assert.ok(maeOverMean(adopted, still) < 1e-6, `${maeOverMean(adopted, still)}`);
    assert.match(refusal, /only MeshStandardMaterial/);
});

test('hooks of the page and those of the bake live side by side', async () => {
    const { still, hooked, chained, taken, plain, detached } = await page.evaluate(async () => {
        const world = await load(true),
            materials = new Set(meshesOfRoom(world).map((mesh) => mesh.material)),
            result = { still: draw(world) };
        const keep = (channels) => (shader) => {
            shader.fragmentShader = shader.fragmentShader.replace(
                '#include <dithering_fragment>',
                `gl_FragColor.rgb *= vec3(${channels});`,
            );
        };
        const set = (hookOf) => {
            for (const material of materials) {
                material.onBeforeCompile = hookOf(material);
                material.needsUpdate = true;
            }
        };
        set(() => keep('1.0, 0.0, 0.0'));
        result.hooked = draw(world);
        // One that calls the hook that it finds, as many do.
        set(({ onBeforeCompile: before }) => function (...all) {
            before.apply(this, all);
            const [shader] = all;
            shader.fragmentShader = shader.fragmentShader.replace('vec3(1.0, 0.0, 0.0)', 'vec3(0.0, 1.0, 0.0)');
        });
        result.chained = draw(world);
        set(() => () => {});
        result.taken = draw(world);
        set(() => keep('0.0, 0.0, 1.0'));
        world.light.detach();
        result.detached = draw(world);
        const other = await load(false);
        for (const mesh of meshesOfRoom(other)) mesh.material.onBeforeCompile = keep('0.0, 0.0, 1.0');
        result.plain = draw(other);
        return result;
    });
    const channel = (all, c) => all.filter((_, i) => i % 4 === c);
    const sum = (values) => values.reduce((a, b) => a + b, 0);
    const assertOnly = (kept, pixels) => {
        const sums = [0, 1, 2].map((c) => sum(channel(pixels, c)));
        assert.ok(sums[kept] > 0.9 * sum(channel(still, kept)), `channel ${kept}: ${sums}`);
        // The background has no material.
        for (const c of [0, 1, 2]) if (c !== kept) assert.ok(sums[c] < 0.05 * sum(channel(still, c)), `${c}: ${sums}`);
    };
    assertOnly(0, hooked);
    assertOnly(1, chained);
    assert.ok(maeOverMean(taken, still) < 1e-6, 'without any');
    assert.ok(maeOverMean(detached, plain) < 1e-6, 'hooks stay when the light goes');
});

// As React's strict mode does: an effect runs, is cleaned up and runs again with what was loaded once.
test('a room that is disposed of is drawn again, by its renderer and by another', async () => {
    const { still, again, first, second, left } = await page.evaluate(async () => {
        const world = await load(true),
            result = { still: draw(world) };
        world.light.dispose();
        result.again = draw(world);
        world.light.dispose();
        const mount = () =>
            withRenderer({}, (other) => {
                const picture = drawBy(other, world);
                world.light.dispose();
                return picture;
            });
        result.first = mount();
        result.second = mount();
        result.left = countAlive();
        world.light.detach();
        return result;
    });
    assert.ok(meanOf(still) > 0);
    for (const [name, picture] of Object.entries({ again, first, second }))
        assert.ok(maeOverMean(picture, still) < 1e-6, `${name}: ${maeOverMean(picture, still)}`);
    assert.equal(left.Framebuffer + left.Program + left.Buffer, 0, JSON.stringify(left));
});

test('a logarithmic depth buffer changes nothing', async () => {
    const [still, logarithmic] = await page.evaluate(async () => {
        const world = await load(true);
        const pictures = [{}, { logarithmicDepthBuffer: true }].map((options) =>
            withRenderer(options, (other) => drawBy(other, world)),
        );
        world.light.detach();
        return pictures;
    });
    // Edges where two surfaces are nearly as deep fall otherwise.
    assert.ok(maeOverMean(logarithmic, still) < 0.003, `${maeOverMean(logarithmic, still)}`);
});

// What was logged while `action` ran in the page.
async function loggedBy(action) {
    const errors = [],
        note = (message) => message.type() === 'error' && errors.push(message.text());
    page.on('console', note);
    const result = await action();
    page.off('console', note);
    return { result, errors: errors.filter((text) => /without its light/.test(text)) };
}

test('a renderer that cannot draw the light says so once, and shows the room unlit', async () => {
    const reversed = await loggedBy(() =>
        page.evaluate(async () => {
            const world = await load(true);
            world.scene.children.find((o) => o.isAmbientLight).intensity = 0;
            const pictures = withRenderer({ reversedDepthBuffer: true }, (other) => [
                drawBy(other, world),
                drawBy(other, world),
            ]);
            world.light.detach();
            return pictures;
        }),
    );
    const webGpu = await loggedBy(() =>
        page.evaluate(async () => {
            const { WebGPURenderer } = await import('three/webgpu');
            const world = await load(true),
                other = new WebGPURenderer({ forceWebGL: true, antialias: false });
            world.scene.children.find((o) => o.isAmbientLight).intensity = 0;
            other.setSize(160, 90);
            await other.init();
            const pictures = [0, 1].map(() => {
                other.render(world.scene, world.camera);
                const copy = new OffscreenCanvas(160, 90).getContext('2d');
                copy.drawImage(other.domElement, 0, 0, 160, 90);
                return [...copy.getImageData(0, 0, 160, 90).data];
            });
            world.light.detach();
            return pictures;
        }),
    );
    for (const [name, { result, errors }, reason] of [
        ['reversed depth', reversed, /not reversed/],
        ['WebGPURenderer', webGpu, /needs WebGLRenderer/],
    ]) {
        assert.equal(errors.length, 1, `${name}: ${errors.join()}`);
        assert.match(errors[0], reason);
        // The first picture, too: a page may draw but one.
        for (const picture of result) assert.ok(meanOf(picture) > 20, `${name}: ${meanOf(picture)}`);
    }
});
