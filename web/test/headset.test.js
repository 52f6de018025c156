// The room in a headset: one that iwer emulates.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { after, before, test } from 'node:test';
import { distance, isAlong, loaded, open, openRoom } from './site.js';

const size = { width: 300, height: 240 }, // the smallest that shows all buttons
    kHeadMeters = 1.75,
    kBeforeWall = '-0.9,1.6,-1.6;0,1.6,-1.6;60'; // between the rooms
let browser, server, close, page;

// Puts a headset on, in which its wearer stands beside the middle of the floor that it knows.
function wear() {
    const { XRDevice, metaQuest3 } = globalThis.IWER;
    globalThis.device = new XRDevice(metaQuest3);
    device.installRuntime({ forceInstall: true }); // the browser has one, which knows no device
    device.stereoEnabled = true;
    device.position.set(0.3, 1.75, -0.2);
    globalThis.statuses = [];
    addEventListener('DOMContentLoaded', () =>
        document.getElementById('room').addEventListener('xr-status', ({ detail }) => statuses.push(detail.status)),
    );
}

const isHidden = (of) => of.evaluate(() => document.getElementById('room').find('headset').hidden);

before(async () => {
    ({ browser, server, close } = await openRoom('house'));
    const iwer = await readFile(new URL('../node_modules/iwer/build/iwer.min.js', import.meta.url), 'utf8');
    page = await loaded(await open(browser, server.url, { size, prepare: `${iwer};(${wear})();` }));
});
after(async () => {
    await page?.close();
    await close?.();
});

// Where the view is: to be asked within a session, too.
const headOf = () => page.evaluate(() => viewer.headset.headWorld.toArray());
const aheadOf = () =>
    page.evaluate(() => {
        const { headset } = viewer,
            { turned, floor, head } = headset;
        return head.clone().set(0, 0, -1).applyQuaternion(turned).transformDirection(floor.matrixWorld).toArray();
    });

async function enter(view = kBeforeWall) {
    await page.evaluate((to) => {
        const room = document.getElementById('room');
        room.view = to;
        room.jumpCameraToGoal();
        room.find('stage').prepend(viewer.canvas); // the emulator has put it before the buttons
    }, view);
    await page.click('#headset');
    await page.waitForFunction(() => viewer.headset?.isPlaced && statuses.at(-1) === 'session-started');
}

// So many frames, in which nothing is drawn: that would take long.
const pass = (frames) =>
    page.evaluate(async (count) => {
        const { renderer, headset } = viewer,
            { render } = renderer;
        renderer.render = () => {};
        await new Promise((done) => {
            let left = count;
            headset.frame = (...args) => {
                Object.getPrototypeOf(headset).frame.apply(headset, args);
                if (--left <= 0) done();
            };
        });
        delete headset.frame;
        renderer.render = render;
    }, frames);

const push = (hand, x, y) => page.evaluate(([h, a, b]) => device.controllers[h].updateAxes('thumbstick', a, b), [hand, x, y]);

test('a room is entered where there is a headset, and the page asks for it', async () => {
    await page.waitForFunction(() => !document.getElementById('room').find('headset').hidden);
    await page.evaluate(() => {
        document.getElementById('room').xr = false;
    });
    await page.waitForFunction(() => document.getElementById('room').ui);
    assert.equal(await isHidden(page), true);
    await page.evaluate(() => {
        document.getElementById('room').xr = true;
    });
    await page.waitForFunction(() => document.getElementById('room').ui?.element && !document.getElementById('room').find('headset').hidden);
    const [width, fitting] = await page.evaluate(() => {
        const { scrollWidth, clientWidth } = document.getElementById('room').find('tools');
        return [scrollWidth, clientWidth];
    });
    assert.ok(width <= fitting, `buttons of ${width} pixels in ${fitting}`);
    const other = await loaded(await open(browser, server.url, { size }));
    await other.waitForFunction(() => document.getElementById('room').ui);
    await other.evaluate(() => navigator.xr.isSessionSupported('immersive-vr'));
    assert.equal(await isHidden(other), true);
    await other.close();
});

test('both eyes see the room as the page shows it, from a person’s own height', async (t) => {
    await enter('-2.4,1.6,1.5;-1.4,1.1,0;60');
    // The place of the page's view, and its heading, but as high above the floor and as level as the headset is.
    assert.ok(distance(await headOf(), [-2.4, kHeadMeters, 1.5]) < 1e-3, `${await headOf()}`);
    assert.ok(distance(await aheadOf(), [1 / Math.hypot(1, 1.5), 0, -1.5 / Math.hypot(1, 1.5)]) < 1e-3, `${await aheadOf()}`);
    const seen = await page.evaluate(
        () =>
            new Promise((done) => {
                const { headset, renderer, light, floor = headset.floor } = viewer,
                    gl = renderer.getContext();
                light.reflections = 'rays';
                floor.traverse((object) => (object.visible = !object.isLine));
                headset.frame = (...args) => {
                    Object.getPrototypeOf(headset).frame.apply(headset, args);
                    if (!light.isWhole || light.tracedMilliseconds === 0) return;
                    delete headset.frame;
                    done(
                        renderer.xr.getCamera().cameras.map(({ matrixWorld, projectionMatrix, viewport }) => {
                            const { x, y, z: width, w: height } = viewport,
                                pixels = new Uint8Array(4 * width * height);
                            gl.readPixels(x, y, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
                            const matrices = [matrixWorld, projectionMatrix].map((matrix) => matrix.toArray());
                            return { matrices, width, height, pixels: [...pixels] };
                        }),
                    );
                };
            }),
    );
    const [left, right] = seen.map(({ matrices: [world] }) => world.slice(12, 15));
    assert.ok(Math.abs(distance(left, right) - 0.063) < 1e-3, 'as far apart as eyes');
    assert.ok(left[0] < right[0], 'the left one to the left');
    await page.evaluate(() => viewer.headset.leave());
    await page.waitForFunction(() => statuses.at(-1) === 'not-presenting');
    const shown = await page.evaluate((eyes) => {
        viewer.stop();
        const { renderer, picture, camera, scene, light, exposure } = viewer,
            gl = renderer.getContext(),
            eye = camera.clone();
        Object.assign(light, { quality: 'fast', seed: 0, waitsForPrograms: true });
        eye.matrixWorldAutoUpdate = false;
        return eyes.map(({ matrices: [world, projection], width, height }) => {
            eye.matrixWorld.fromArray(world);
            eye.matrixWorldInverse.copy(eye.matrixWorld).invert();
            eye.projectionMatrix.fromArray(projection);
            picture.setSize(width, height);
            picture.forget();
            picture.add(scene, eye, Infinity);
            picture.present(exposure);
            const pixels = new Uint8Array(4 * width * height);
            gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
            return [...pixels];
        });
    }, seen.map(({ matrices, width, height }) => ({ matrices, width, height })));
    const difference = (a, b) => a.reduce((sum, x, i) => sum + Math.abs(x - b[i]), 0) / (0.75 * a.length);
    seen.forEach(({ pixels }, i) => {
        t.diagnostic(`eye ${i}: ${difference(pixels, shown[i]).toFixed(3)} steps of 255`);
        assert.ok(difference(pixels, shown[i]) < 0.1, `eye ${i}: ${difference(pixels, shown[i])}`);
    });
    assert.ok(difference(shown[0], shown[1]) > 2, 'two views');
    await page.evaluate(() => {
        viewer.light.reflections = 'lookup';
        viewer.resize();
        viewer.run();
    });
});

test('sticks walk and turn, and walls hold', async () => {
    await enter();
    const start = await headOf();
    await push('left', 0, 1); // backward
    await pass(12);
    await push('left', 0, 0);
    await pass(2);
    const back = await headOf();
    assert.ok(start[0] - back[0] > 0.2, `${start} to ${back}`);
    assert.ok(Math.abs(back[1] - kHeadMeters) < 0.01 && Math.abs(back[2] - start[2]) < 0.01, `${back}`);
    await push('right', 1, 0);
    await pass(6);
    await push('right', 0, 0);
    await pass(2);
    assert.ok(distance(await headOf(), back) < 1e-3, 'on the spot');
    const turned = await aheadOf(),
        angle = Math.PI / 6; // once, to the right of +x
    assert.ok(distance(turned, [Math.cos(angle), 0, Math.sin(angle)]) < 1e-3, `${turned}`);
    await page.evaluate(() => viewer.headset.turn(Math.PI / 6));
    await push('right', 0, -1);
    await pass(60);
    const [x, y] = await headOf();
    assert.ok(x > -0.9 + 0.3 && x < -0.25, `before the wall: ${x}`);
    assert.ok(Math.abs(y - kHeadMeters) < 0.01, `${y}`);
    await push('right', 0, 0);
    await page.evaluate(() => viewer.headset.leave());
    await page.waitForFunction(() => statuses.at(-1) === 'not-presenting');
});

test('who points at the floor is there, and the page goes on from there', async () => {
    await enter('-2.4,1.6,1.5;-1.4,1.6,1.5;60');
    const from = await headOf();
    await page.evaluate(() => {
        const { right } = device.controllers;
        right.position.set(0.5, 1.2, -0.2);
        right.quaternion.set(Math.sin(-0.35), 0, 0, Math.cos(-0.35)); // 40 degrees down
    });
    await pass(3);
    const ahead = await aheadOf();
    await page.evaluate(() => device.controllers.right.updateButtonValue('trigger', 1));
    await pass(3);
    await page.evaluate(() => device.controllers.right.updateButtonValue('trigger', 0));
    await pass(3);
    const to = await headOf();
    assert.ok(Math.abs(to[1] - kHeadMeters) < 1e-3, `${to}`);
    assert.ok(isAlong([to[0] - from[0], 0, to[2] - from[2]], ahead, 0.95), `${from} to ${to}, ahead ${ahead}`);
    assert.ok(distance(from, to) > 1, `${from} to ${to}`);
    await page.evaluate(() => document.getElementById('room').find('headset').click());
    await page.waitForFunction(() => statuses.at(-1) === 'not-presenting' && viewer.picture.samples > 0);
    const left = await page.evaluate(() => ({
        eye: viewer.camera.position.toArray(),
        mode: viewer.navigation.mode,
        presents: viewer.renderer.xr.isPresenting,
        pressed: document.getElementById('room').find('headset').getAttribute('aria-pressed'),
    }));
    assert.ok(distance(left.eye, to) < 1e-3, `${left.eye}`);
    assert.deepEqual([left.mode, left.presents, left.pressed], ['walk', false, 'false']);
    assert.deepEqual(page.problems, []);
});

test('a session ends with its room', async () => {
    await enter();
    await page.evaluate(() => document.getElementById('room').remove());
    await page.waitForFunction(() => statuses.at(-1) === 'not-presenting');
    assert.deepEqual(page.problems, []);
});
