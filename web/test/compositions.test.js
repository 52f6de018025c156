// The plug-in in pages that draw otherwise than by one call of `renderer.render` to the canvas.
/* global EffectComposer, RenderPass, UnrealBloomPass, GTAOPass, OutputPass, Reflector, world, composed, bloom */
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { maeOverMean, meanOf } from './room.js';
import { openPluginRoom } from './site.js';

let page, close;

before(async () => {
    ({ page, close } = await openPluginRoom());
    await page.evaluate(async () => {
        const names = ['EffectComposer', 'RenderPass', 'UnrealBloomPass', 'GTAOPass', 'OutputPass'];
        for (const name of names)
            globalThis[name] = (await import(`three/addons/postprocessing/${name}.js`))[name];
        globalThis.Reflector = (await import('three/addons/objects/Reflector.js')).Reflector;
        globalThis.world = await load(true);
        globalThis.composed = (...passes) => {
            const composer = new EffectComposer(renderer);
            for (const pass of [new RenderPass(world.scene, world.camera), ...passes, new OutputPass()])
                composer.addPass(pass);
            composer.render();
            return readCanvas();
        };
        globalThis.bloom = (strength) => new UnrealBloomPass(new THREE.Vector2(160, 90), strength, 0.5, 0.5);
    });
});
after(() => close?.());

// Half floats between the passes round to 2^-11 of a value, bytes to half a step: two steps of 255 are
// allowed.
function assertSame(a, b, what) {
    assert.equal(a.length, b.length);
    const most = a.reduce((m, x, i) => Math.max(m, Math.abs(x - b[i])), 0);
    assert.ok(most <= 2, `${what}: ${most} steps apart`);
}

test('EffectComposer shows what the renderer shows, by every tone mapping', async () => {
    const pictures = await page.evaluate(() => {
        const result = {};
        for (const name of ['No', 'Linear', 'Reinhard', 'Cineon', 'ACESFilmic', 'AgX', 'Neutral']) {
            renderer.toneMapping = THREE[`${name}ToneMapping`];
            result[name] = [draw(world), composed()];
        }
        renderer.toneMapping = THREE.NoToneMapping;
        return result;
    });
    for (const [name, [plain, composed]] of Object.entries(pictures)) {
        assertSame(composed, plain, name);
        assert.ok(meanOf(plain) > 20, `${name} is not black`);
    }
    assert.ok(maeOverMean(pictures.AgX[0], pictures.No[0]) > 0.02);
});

test('bloom adds to the light, fog and a clear colour stay', async () => {
    const pictures = await page.evaluate(() => {
        const { scene, camera } = world,
            result = { plain: draw(world), none: composed(bloom(0)), some: composed(bloom(1)) };
        // three.js itself mixes fog with what is encoded already, and encodes a composer's clear colour
        // twice.
        renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
        scene.fog = new THREE.Fog(0x00ff00, 0, 8);
        const recompile = () =>
            world.gltf.scene.traverse((o) => {
                if (o.isMesh) o.material.needsUpdate = true;
            });
        recompile();
        result.fog = [draw(world), composed()];
        scene.fog = null;
        recompile();
        // From far outside, so that most of the picture is empty.
        const place = camera.matrixWorld.clone();
        camera.position.multiplyScalar(8);
        camera.lookAt(0, 0, 0);
        renderer.setClearColor(0x336699, 1);
        draw(world);
        result.far = [draw(world), composed()];
        renderer.setClearColor(0x000000, 0);
        renderer.outputColorSpace = THREE.SRGBColorSpace;
        place.decompose(camera.position, camera.quaternion, camera.scale);
        return result;
    });
    const { plain, none, some, fog, far } = pictures;
    assertSame(none, plain, 'bloom of no strength');
    assert.ok(some.every((x, i) => x >= plain[i] - 2) && meanOf(some) > 1.02 * meanOf(plain), 'bloom');
    assertSame(fog[1], fog[0], 'fog');
    assert.ok(maeOverMean(fog[0], plain) > 0.1, 'there is fog');
    assertSame(far[1], far[0], 'clear colour');
    const corner = far[0].slice(0, 3);
    assert.ok(corner[0] > 0 && corner[0] < corner[1] && corner[1] < corner[2], `clear colour ${corner}`);
    const roomPixels = far[0].filter((x, i) => i % 4 === 0 && x !== corner[0]).length;
    assert.ok(roomPixels > 100, 'the room is in the picture');
});

test('passes that draw normals cost no second lookup', async () => {
    const [plain, occluded] = await page.evaluate(() => [
        workOf(() => composed()).drawn,
        workOf(() => composed(new GTAOPass(world.scene, world.camera, 160, 90))).drawn,
    ]);
    assert.ok(plain > 0);
    assert.equal(occluded, plain);
});

test('draws into targets of any size and into multisampled ones', async () => {
    const { canvas, target, fine, smooth, rough } = await page.evaluate(() => {
        const { scene, camera } = world;
        const into = (width, height, samples) => {
            const options = { type: THREE.FloatType, samples };
            const drawn = new THREE.WebGLRenderTarget(width, height, options);
            renderer.setRenderTarget(drawn);
            renderer.render(scene, camera);
            const pixels = readTarget(drawn);
            renderer.setRenderTarget(null);
            drawn.dispose();
            return pixels;
        };
        renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
        const pictures = { canvas: draw(world) };
        renderer.outputColorSpace = THREE.SRGBColorSpace;
        pictures.target = into(160, 90, 0).map((x) => 255 * Math.min(Math.max(x, 0), 1));
        world.light.quality = 'high'; // less noise, so that edges count
        [pictures.fine, pictures.smooth, pictures.rough] = [
            into(640, 360, 0),
            into(160, 90, 4),
            into(160, 90, 0),
        ];
        world.light.quality = 'fast';
        return pictures;
    });
    assertSame(target, canvas, 'target');
    const averaged = rough.map((_, i) => {
        const [c, x, y] = [i % 4, Math.floor(i / 4) % 160, Math.floor(i / 640)];
        let sum = 0;
        for (let j = 0; j < 16; ++j) sum += fine[4 * (640 * (4 * y + (j >> 2)) + 4 * x + (j & 3)) + c];
        return sum / 16;
    });
    // Pixels that show two surfaces.
    const isEdge = rough.map((x, i) => Math.abs(x - smooth[i]) > 0.02 * Math.abs(x));
    const edges = (all) => all.filter((_, i) => isEdge[i]);
    assert.ok(edges(rough).length > 1000);
    const [withSamples, without] = [smooth, rough].map((of) => maeOverMean(edges(of), edges(averaged)));
    assert.ok(withSamples < 0.6 * without, `edges: ${withSamples} and ${without}`);
});

test('viewports show what they show alone', async () => {
    const { alone, beside, array } = await page.evaluate(() => {
        const { scene, camera } = world;
        const cameras = [-0.3, 0.3].map((x) => {
            const moved = camera.clone();
            camera.matrixWorld.decompose(moved.position, moved.quaternion, moved.scale);
            moved.position.x += x;
            moved.aspect = 80 / 60;
            moved.updateProjectionMatrix();
            moved.updateMatrixWorld();
            return moved;
        });
        const corners = [
            [0, 0],
            [80, 20],
        ];
        const show = (i, [x, y]) => {
            renderer.setViewport(x, y, 80, 60);
            renderer.setScissor(x, y, 80, 60);
            renderer.render(scene, cameras[i]);
        };
        const cut = (all, [left, bottom]) => {
            const part = [];
            for (let y = bottom; y < bottom + 60; ++y)
                part.push(...all.slice(4 * (160 * y + left), 4 * (160 * y + left + 80)));
            return part;
        };
        renderer.setScissorTest(true);
        const alone = cameras.map((_, i) => {
            show(i, [0, 0]);
            return cut(readCanvas(), [0, 0]);
        });
        show(0, corners[0]);
        show(1, corners[1]);
        const both = readCanvas();
        renderer.setScissorTest(false);
        renderer.setViewport(0, 0, 160, 90);
        cameras.forEach((of, i) => {
            of.viewport = new THREE.Vector4(...corners[i], 80, 60);
        });
        // What WebXR draws with. (Its own view is for older versions of three.js, which leave out what it
        // does not see.)
        const eyes = new THREE.ArrayCamera(cameras);
        camera.matrixWorld.decompose(eyes.position, eyes.quaternion, eyes.scale);
        eyes.fov = 120;
        eyes.updateProjectionMatrix();
        renderer.render(scene, eyes);
        const byEyes = readCanvas();
        return {
            alone,
            beside: [cut(both, corners[0]), cut(both, corners[1])],
            array: [cut(byEyes, corners[0]), cut(byEyes, corners[1])],
        };
    });
    assert.ok(maeOverMean(alone[0], alone[1]) > 0.05, 'two views');
    for (const i of [0, 1]) {
        assertSame(beside[i], alone[i], `viewport ${i}`);
        assertSame(array[i], alone[i], `camera ${i} of an ArrayCamera`);
    }
});

test('cube maps, mirrors and glass show the light', async () => {
    const { faces, flat, without, mirror, glass, masks, unlit } = await page.evaluate(() => {
        const { scene, camera, light } = world;
        const cube = new THREE.WebGLCubeRenderTarget(48, { type: THREE.FloatType });
        const probe = new THREE.CubeCamera(0.01, 20, cube);
        probe.position.set(0, 1.2, 0);
        scene.add(probe);
        probe.update(renderer, scene);
        const faces = probe.children.map((_, face) => readTarget(cube, face));
        const target = new THREE.WebGLRenderTarget(48, 48, { type: THREE.FloatType });
        const flat = probe.children.map((of) => {
            renderer.setRenderTarget(target);
            renderer.render(scene, of);
            const pixels = readTarget(target);
            renderer.setRenderTarget(null);
            return pixels;
        });
        light.enabled = false;
        const unlit = { cube: (probe.update(renderer, scene), readTarget(cube, 0)) };
        light.enabled = true;
        scene.remove(probe);

        // In front of the camera, over a part of the picture; drawn first, which interrupts the room's
        // picture.
        const inFront = (mesh) => {
            const ahead = new THREE.Vector3(0, 0, -1).transformDirection(camera.matrixWorld);
            mesh.position.setFromMatrixPosition(camera.matrixWorld).addScaledVector(ahead, 0.4);
            mesh.lookAt(camera.getWorldPosition(new THREE.Vector3()));
            mesh.rotateX(0.6);
            return mesh;
        };
        const square = new THREE.PlaneGeometry(0.08, 0.08);
        const withMesh = (mesh) => {
            scene.add(mesh);
            const pixels = draw(world);
            light.enabled = false;
            const dark = draw(world);
            light.enabled = true;
            scene.remove(mesh);
            return { pixels, dark };
        };
        const mirrors = [-1, 1].map((renderOrder) => {
            const mesh = inFront(new Reflector(square, { textureWidth: 64, textureHeight: 64 }));
            mesh.renderOrder = renderOrder;
            return withMesh(mesh);
        });
        const pane = new THREE.MeshPhysicalMaterial({ transmission: 1, roughness: 0, color: 0xffffff });
        const mask = inFront(new THREE.Mesh(square, new THREE.MeshBasicMaterial({ color: 0xff00ff })));
        return {
            faces,
            flat,
            unlit,
            without: draw(world),
            mirror: mirrors,
            glass: withMesh(inFront(new THREE.Mesh(square, pane))),
            masks: withMesh(mask).pixels,
        };
    });
    faces.forEach((face, i) =>
        assertSame(
            face.map((x) => 255 * x),
            flat[i].map((x) => 255 * x),
            `face ${i}`,
        ),
    );
    assert.ok(meanOf(faces[0]) > 1.5 * meanOf(unlit.cube), 'a cube map');
    const isIn = (i) => masks[i - (i % 4)] === 255 && masks[i - (i % 4) + 1] === 0;
    const inside = (all) => all.filter((_, i) => isIn(i)),
        outside = (all) => all.filter((_, i) => !isIn(i));
    assert.ok(inside(masks).length > 400 && outside(masks).length > 4000);
    for (const [name, { pixels, dark }] of Object.entries({ before: mirror[0], after: mirror[1], glass })) {
        // A border pixel may show either.
        assert.ok(maeOverMean(outside(pixels), outside(without)) < 2e-3, `around ${name}`);
        assert.ok(meanOf(inside(pixels)) > 1.5 * meanOf(inside(dark)), `in ${name}`);
    }
});

test('two renderers show one room, one by effects of its own', async () => {
    const { first, second, third, again, left } = await page.evaluate(() => {
        const other = new THREE.WebGLRenderer({
            antialias: false,
            preserveDrawingBuffer: true,
            outputBufferType: THREE.HalfFloatType,
        });
        other.setSize(160, 90);
        other.setEffects([bloom(0)]);
        renderer.toneMapping = other.toneMapping = THREE.AgXToneMapping;
        const first = draw(world);
        other.render(world.scene, world.camera);
        const second = readCanvas(other);
        const again = workOf(() => renderer.render(world.scene, world.camera));
        const third = readCanvas();
        world.light.dispose();
        other.dispose();
        other.forceContextLoss();
        return { first, second, third, again, left: countAlive() };
    });
    assertSame(second, first, 'the other one');
    assertSame(third, first, 'again');
    assert.ok(again.drawn > 0);
    assert.equal(again.made, 0);
    assert.equal(left.Framebuffer + left.Program + left.Buffer, 0, JSON.stringify(left));
});
