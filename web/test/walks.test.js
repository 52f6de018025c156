// How the view moves in the page of `phat web`: on foot, round a point, from viewpoint to viewpoint, by its address.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { door, slit } from './house.js';
import { distance, eyeOf, forwardOf, loaded, open, openRoom, rest } from './site.js';

const size = { width: 480, height: 320 };
let browser, server, close, page;

before(async () => {
    ({ browser, server, close } = await openRoom('house'));
    page = await loaded(await open(browser, server.url, { size }));
    await rest(page);
});
after(async () => {
    await page?.close();
    await close?.();
});

// Puts the eye somewhere, looking along an angle from -z to the left, and walks by a key for so long. Returns the places.
const walk = ({ from, toward, key, seconds }) =>
    page.evaluate(
        ([[x, y, z], angle, pressed, end]) => {
            const { navigation, camera } = viewer,
                view = camera.clone();
            view.position.set(x, y, z);
            view.rotation.set(0, angle, 0);
            view.updateMatrixWorld();
            navigation.goTo(view);
            const places = [camera.position.toArray()];
            navigation.pressed.add(pressed);
            for (let t = 0; t < end; t += 0.05) {
                navigation.advance(0.05);
                places.push(camera.position.toArray());
            }
            navigation.pressed.clear();
            return places;
        },
        [from, toward, key, seconds],
    );

const kEast = -Math.PI / 2;

for (const caster of ['the surfaces', 'the trees'])
    test(`a body passes a door, no slit and no wall, by ${caster}`, async () => {
        await page.evaluate((isTree) => isTree && viewer.light.loadTrees(), caster === 'the trees');
        for (const [z, reaches] of [
            [(door.from + door.to) / 2, true],
            [(slit.from + slit.to) / 2, false],
            [0, false],
        ]) {
            const places = await walk({ from: [-0.9, 1.6, z], toward: kEast, key: 'w', seconds: 2 }),
                [x, y] = places.at(-1);
            assert.equal(x > 1, reaches, `at z = ${z} to x = ${x}`);
            assert.ok(Math.abs(y - 1.6) < 0.01, `at eye height: ${y}`);
            // Before the wall's side, and in the slit with less than half of a body.
            if (!reaches) assert.ok(x > -0.5 && x < (z === 0 ? -0.25 : -0.05), `at z = ${z} to x = ${x}`);
        }
    });

test('the trees and three.js know the same walls', async () => {
    const [byTrees, bySurfaces] = await page.evaluate(async () => {
        await viewer.light.loadTrees();
        const { walls } = viewer,
            origin = viewer.camera.position.clone(),
            direction = origin.clone();
        const distances = () => {
            const all = [];
            for (let i = 0; i < 400; ++i) {
                // Of a sequence that fills the room, and the sphere.
                const [u, v, w] = [0.7549, 0.5698, 0.1237].map((step) => (step * i) % 1);
                origin.set(5.8 * u - 2.9, 0.1 + 2.3 * v, 3.8 * w - 1.9);
                const [phi, z] = [6.2832 * ((0.618 * i) % 1), 2 * ((0.414 * i) % 1) - 1],
                    flat = Math.sqrt(1 - z * z);
                direction.set(flat * Math.cos(phi), z, flat * Math.sin(phi));
                all.push(walls.distance(origin, direction, 4));
            }
            return all;
        };
        // three.js does not meet the backs of surfaces that have none.
        const kDoubleSide = 2;
        viewer.materials.forEach((material) => (material.side = kDoubleSide));
        const first = distances();
        walls.still = false;
        const second = distances();
        walls.still = true;
        return [first, second];
    });
    const nearer = byTrees.filter((far) => far < 4).length,
        errors = byTrees.map((far, i) => Math.abs(far - bySurfaces[i]));
    assert.ok(nearer > 300, `${nearer} hits`);
    assert.ok(Math.max(...errors) < 1e-4, `${Math.max(...errors)}`);
});

test('who walks into a wall aslant goes along it', async () => {
    const places = await walk({ from: [-2.5, 1.6, -1.5], toward: 0.7 - kEast, key: 'w', seconds: 1.5 }),
        [x, , z] = places.at(-1);
    assert.ok(x > -2.8 && x < -2.7 && z > -0.5, `${x}, ${z}`);
});

test('the eye comes to eye height on the floor, not onto the table', async () => {
    const [, y] = (await walk({ from: [-2.5, 2.4, -1], toward: kEast, key: 'w', seconds: 1 })).at(-1);
    assert.ok(Math.abs(y - 1.6) < 0.01, `from the ladder: ${y}`);
    const [x, height] = (await walk({ from: [-2.6, 1.6, 0], toward: kEast, key: 'w', seconds: 2 })).at(-1);
    assert.ok(x < -2 && Math.abs(height - 1.6) < 0.01, `before the table: ${x}, ${height}`);
});

test('letters walk by what is on the keys, other scripts by their place', async () => {
    await page.evaluate(() => viewer.navigation.goTo(viewer.cameras[0]));
    const pressed = (init) =>
        page.evaluate((event) => {
            viewer.canvas.dispatchEvent(new KeyboardEvent('keydown', event));
            const all = [...viewer.navigation.pressed];
            viewer.canvas.dispatchEvent(new KeyboardEvent('keyup', event));
            return [all, viewer.navigation.pressed.size];
        }, init);
    assert.deepEqual(await pressed({ key: 'W', code: 'KeyZ', shiftKey: true }), [['w'], 0]); // French
    assert.deepEqual(await pressed({ key: 'ц', code: 'KeyW' }), [['w'], 0]);
    assert.deepEqual(await pressed({ key: 'x', code: 'KeyX' }), [[], 0]);
});

const settle = (seconds) =>
    page.evaluate((end) => {
        for (let t = 0; t < end; t += 0.05) viewer.navigation.advance(0.05);
    }, seconds);

test('a tap on the floor leads there, one on a wall nowhere', async () => {
    await page.evaluate(() => viewer.navigation.goTo(viewer.cameras[1]));
    const goal = [-2.2, 0, 1];
    const place = ([x, y, z]) =>
        page.evaluate(
            ([a, b, c]) => {
                const at = viewer.camera.position.clone().set(a, b, c).project(viewer.camera);
                return [((1 + at.x) / 2) * innerWidth, ((1 - at.y) / 2) * innerHeight];
            },
            [x, y, z],
        );
    await page.evaluate(() => {
        const down = viewer.camera.clone();
        down.rotation.set(-0.7, Math.PI, 0, 'YXZ');
        down.position.set(-2.4, 1.6, -1.2);
        down.updateMatrixWorld();
        viewer.navigation.goTo(down);
    });
    await page.mouse.click(...(await place(goal)));
    await settle(2);
    const [x, , z] = await eyeOf(page);
    assert.ok(Math.hypot(x - goal[0], z - goal[2]) < 0.1, `${x}, ${z}`);
    const before = await eyeOf(page);
    await page.evaluate(() => viewer.navigation.modes.walk.turn(0, 0.7));
    await page.mouse.click(240, 60);
    await settle(1);
    assert.deepEqual(await eyeOf(page), before);
});

test('two fingers look around, too, and walk as they part', async () => {
    await page.evaluate(() => viewer.navigation.goTo(viewer.cameras[1]));
    const client = await page.context().newCDPSession(page);
    const touch = (type, ...places) =>
        client.send('Input.dispatchTouchEvent', { type, touchPoints: places.map(([x, y], id) => ({ x, y, id })) });
    const [from, forward] = [await eyeOf(page), await forwardOf(page)];
    await touch('touchStart', [150, 100], [250, 100]);
    await touch('touchMove', [170, 100], [270, 100]);
    await touch('touchMove', [210, 100], [310, 100]);
    await touch('touchEnd');
    await page.waitForFunction(
        ([x, y, z]) => viewer.camera.getWorldDirection(viewer.camera.position.clone()).dot({ x, y, z }) < 0.999,
        forward,
    );
    assert.ok(distance(await eyeOf(page), from) < 0.1, 'the eye is nearly where it was');
    await touch('touchStart', [190, 100], [250, 100]);
    await touch('touchMove', [180, 100], [260, 100]);
    await touch('touchMove', [160, 100], [280, 100]);
    await touch('touchEnd');
    await page.waitForFunction(([x, y, z]) => viewer.camera.position.distanceTo({ x, y, z }) > 0.3, from);
});

test('viewpoints are reached by a smooth way, or at once where a wall is between', async () => {
    const travel = (from, to) =>
        page.evaluate(
            ([a, b]) => {
                const { navigation, camera, cameras } = viewer;
                navigation.goTo(cameras[a]);
                navigation.travel(cameras[b]);
                const places = [camera.position.toArray()];
                for (let i = 0; i < 20 && navigation.trip; ++i) {
                    navigation.advance(0.1);
                    places.push(camera.position.toArray());
                }
                return { places, goal: cameras[b].position.toArray() };
            },
            [from, to],
        );
    const smooth = await travel(0, 1);
    assert.ok(smooth.places.length > 10, `${smooth.places.length} pictures`);
    assert.ok(distance(smooth.places.at(-1), smooth.goal) < 1e-6);
    const steps = smooth.places.slice(1).map((place, i) => distance(place, smooth.places[i]));
    assert.ok(Math.max(...steps) < 0.2 * distance(smooth.places[0], smooth.goal), `${Math.max(...steps)}`);
    const cut = await travel(0, 2);
    assert.equal(cut.places.length, 1);
    assert.ok(distance(cut.places[0], cut.goal) < 1e-6);
});

test('buttons lead from viewpoint to viewpoint, and a tour through all, until somebody looks around', async () => {
    const shown = () => page.$eval('#camera', (select) => select.selectedOptions[0]?.textContent ?? '');
    await page.evaluate(() => viewer.navigation.goTo(viewer.cameras[0]));
    assert.equal(await shown(), 'Living room');
    for (const [button, name] of [
        ['next', 'Window'],
        ['next', 'Kitchen'],
        ['next', 'Living room'],
        ['previous', 'Kitchen'],
    ]) {
        await page.click(`#${button}`);
        assert.equal(await shown(), name);
        await page.evaluate(() => document.getElementById('room').jumpCameraToGoal());
        assert.equal(await shown(), name);
    }
    await page.click('#tour');
    assert.equal(await shown(), 'Living room');
    assert.equal(await page.getAttribute('#tour', 'aria-pressed'), 'true');
    await page.waitForFunction(() => document.getElementById('room').find('camera').selectedIndex === 1);
    await page.mouse.move(240, 60);
    await page.mouse.down();
    await page.mouse.move(260, 60, { steps: 2 });
    await page.mouse.up();
    assert.equal(await page.getAttribute('#tour', 'aria-pressed'), 'false');
    assert.equal(await page.evaluate(() => viewer.navigation.trip), null);
});

test('the address has the view, without new entries of the history, and another page begins there', async () => {
    const entries = await page.evaluate(() => history.length);
    await page.evaluate(() => viewer.navigation.goTo(viewer.cameras[2]));
    await page.waitForFunction(() => location.hash.startsWith('#view=2.4,1.6,1.5;'));
    assert.equal(await page.evaluate(() => history.length), entries);
    const query = await page.evaluate(() => location.hash);
    const [eye, forward] = [await eyeOf(page), await forwardOf(page)];
    const other = await loaded(await open(browser, server.url, { size, query }));
    await rest(other);
    assert.ok(distance(await eyeOf(other), eye) < 1e-3 && distance(await forwardOf(other), forward) < 1e-3);
    // An address that is typed in.
    await other.evaluate(() => {
        location.hash = '#view=-2,1.5,1;-2,1.5,0;50';
    });
    await other.waitForFunction(() => {
        document.getElementById('room').jumpCameraToGoal(); // at rest, nothing moves by itself
        return viewer.camera.position.x < -1;
    });
    assert.equal(await other.evaluate(() => viewer.navigation.view), '-2,1.5,1;-2,1.5,0;50');
    // One that is no view is not followed.
    await other.evaluate(() => {
        location.hash = '#view=1,2,3;%;';
    });
    assert.deepEqual(other.problems, []);
    await other.close();
});

test('who wants no motion is moved at once', async () => {
    const still = await browser.newPage({ viewport: size, reducedMotion: 'reduce' });
    await still.goto(server.url);
    await loaded(still);
    await rest(still);
    const { eye, goal } = await still.evaluate(() => {
        viewer.navigation.travel(viewer.cameras[1]);
        return { eye: viewer.camera.position.toArray(), goal: viewer.cameras[1].position.toArray() };
    });
    assert.ok(distance(eye, goal) < 1e-6);
    await still.close();
});
