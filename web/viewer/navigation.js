// The view: walked inside a room, orbited elsewhere or where asked for, and moved from viewpoint to viewpoint.
import { Box3, MathUtils, PerspectiveCamera, Quaternion, Sphere, Vector3 } from 'three';
import { Orbit, orbitKeys } from './orbit.js';
import { Walk, walkKeys } from './walk.js';

const kTripSeconds = 1.4; // from one viewpoint to another
const kDigits = 5;
// Of scenes that are in metres: from about one across to 240.
const kSmallestUnit = 0.12,
    kLargestUnit = 30;

export function sphereOf(root) {
    const sphere = new Box3().setFromObject(root).getBoundingSphere(new Sphere());
    sphere.radius ||= 1; // of a point
    return sphere;
}

// From "eye target fov", vertical and in degrees, separated by anything but digits; null from other text.
export function viewFrom(text) {
    const numbers = (text.match(/-?[\d.]+(?:e[-+]?\d+)?/gi) ?? []).map(Number);
    if (numbers.length !== 7 || !numbers.every(Number.isFinite) || !(numbers[6] > 0 && numbers[6] < 180)) return null;
    const view = new PerspectiveCamera(numbers[6]);
    view.position.fromArray(numbers);
    view.lookAt(...numbers.slice(3, 6));
    view.updateMatrixWorld();
    return view;
}

// A metre of a body, in the file's metres. Files of an unlikely size are in other units, of a power of ten.
// `unitMeters`: BakedLight.unitMeters.
function bodyMeter(unitMeters) {
    return unitMeters > kSmallestUnit && unitMeters < kLargestUnit ? 1 : 10 ** Math.round(Math.log10(unitMeters));
}

// Boxes that rooms consist of, from the numbers that `phat web` writes into the page: low and high corners.
function boxesOf(numbers) {
    const all = numbers.split(' ').map(Number),
        corner = (i) => new Vector3(...all.slice(i, i + 3));
    return Array.from({ length: Math.floor(all.length / 6) }, (_, i) => new Box3(corner(6 * i), corner(6 * i + 3)));
}

// The letter on the key that is pressed; where a keyboard writes other letters, that of its place.
function nameOf({ key, code }) {
    if (key === '=') return '+';
    if (key.length > 1 || /[-+0-9a-z]/i.test(key)) return key.length > 1 ? key : key.toLowerCase();
    return /^Key/.test(code) ? code.slice(3).toLowerCase() : key;
}

export class Navigation {
    // `options`: camera, canvas, root, walls, unitMeters; rooms, as numbers; reducesMotion(); changed(byUser), which is
    // called when the view is another one.
    constructor(options) {
        const radius = sphereOf(options.root).radius,
            changed = () => options.changed(true),
            meter = bodyMeter(options.unitMeters);
        Object.assign(this, options, { radius, meter, rooms: boxesOf(options.rooms) });
        this.listening = new AbortController();
        const { signal } = this.listening;
        this.modes = {
            orbit: new Orbit({ ...options, radius, meter, changed }),
            walk: new Walk({ ...options, meter, changed }, signal),
        };
        this.asked = ''; // for a mode
        this.pressed = new Set();
        const { canvas } = this;
        canvas.addEventListener('keydown', (event) => this.pressKey(event), { signal });
        canvas.addEventListener('keyup', (event) => this.pressed.delete(nameOf(event)), { signal });
        canvas.addEventListener('blur', () => this.pressed.clear(), { signal });
        for (const name of ['pointerdown', 'wheel'])
            canvas.addEventListener(name, () => this.endTrip(), { signal, capture: true, passive: true });
    }

    // For something else than to walk there. Returns a function that gives them back.
    takeTaps() {
        const { walk } = this.modes;
        walk.goesToTaps = false;
        return () => (walk.goesToTaps = true);
    }

    pressKey(event) {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const key = nameOf(event);
        if (key === '0') this.goTo(this.first);
        else if (!(key in { ...walkKeys, ...orbitKeys })) return;
        else this.pressed.add(key);
        this.endTrip();
        this.fast = event.shiftKey;
        event.preventDefault();
        this.changed(true);
    }

    isInside(place) {
        const { rooms, walls, radius } = this;
        return rooms.length > 0 ? rooms.some((box) => box.containsPoint(place)) : walls.encloses(place, 2 * radius);
    }

    get mode() {
        return this.current === this.modes.walk ? 'walk' : 'orbit';
    }

    // 'orbit', 'walk', or '': as fits where the eye is.
    ask(mode) {
        this.asked = mode;
        if (this.asked === 'walk' && !this.isInside(this.camera.position)) this.goInside();
        else this.chooseMode();
        this.changed(false);
    }

    // To the first viewpoint in a room, else to a room's middle.
    goInside() {
        const { rooms, camera } = this,
            placeOf = (view) => new Vector3().setFromMatrixPosition(view.matrixWorld);
        const view = this.viewpoints.find((each) => this.isInside(placeOf(each)));
        if (view) return this.goTo(view);
        const middle = rooms[0]?.getCenter(new Vector3()),
            [x, y, z] = middle?.toArray() ?? camera.position.toArray(),
            ahead = camera.getWorldDirection(new Vector3()).setY(0).add(new Vector3(x, y, z));
        return this.goTo(viewFrom([x, y, z, ...ahead.toArray(), this.fov].join(' ')));
    }

    chooseMode() {
        const inside = this.isInside(this.camera.position);
        this.current?.leave();
        this.current = this.modes[this.asked] ?? this.modes[inside ? 'walk' : 'orbit'];
        this.current.enter(inside);
    }

    // At once.
    goTo(view) {
        this.trip = null;
        this.first = view;
        this.fov = view.fov;
        const { camera } = this;
        view.matrixWorld.decompose(camera.position, camera.quaternion, new Vector3());
        this.setAspect(camera.aspect);
        camera.updateMatrixWorld();
        this.chooseMode();
        this.changed(false);
    }

    // Smoothly, but at once where a wall is between, or where motion is not wanted.
    travel(view) {
        const goal = new Vector3().setFromMatrixPosition(view.matrixWorld);
        if (this.reducesMotion() || !this.walls.isFree(this.camera.position, goal)) {
            this.goTo(view);
            return;
        }
        this.current.leave();
        const { position, quaternion } = this.camera;
        this.trip = { view, fov: this.fov, position: position.clone(), quaternion: quaternion.clone(), part: 0 };
    }

    // Where it has come to.
    endTrip() {
        if (!this.trip) return;
        this.trip = null;
        this.chooseMode();
    }

    // At once at the end.
    jump() {
        if (this.trip) this.goTo(this.trip.view);
    }

    advanceTrip(seconds) {
        const { trip, camera } = this;
        trip.part += seconds / kTripSeconds;
        if (trip.part >= 1) {
            this.goTo(trip.view);
            return;
        }
        const eased = MathUtils.smoothstep(trip.part, 0, 1),
            [goal, turned] = [new Vector3(), new Quaternion()];
        trip.view.matrixWorld.decompose(goal, turned, new Vector3());
        camera.position.lerpVectors(trip.position, goal, eased);
        camera.quaternion.slerpQuaternions(trip.quaternion, turned, eased);
        this.fov = MathUtils.lerp(trip.fov, trip.view.fov, eased);
        this.setAspect(camera.aspect);
        this.changed(false);
    }

    // Moves by what is under way. Returns whether the view has changed.
    advance(seconds) {
        if (!this.trip) return this.current.advance(seconds, this.pressed, this.fast);
        this.advanceTrip(seconds);
        return true;
    }

    // "eye;target;fov", as viewFrom reads it.
    get view() {
        const { camera } = this,
            ahead = camera.getWorldDirection(new Vector3()).multiplyScalar(this.meter).add(camera.position);
        const target = this.mode === 'orbit' ? this.modes.orbit.target : ahead,
            short = (x) => Number(x.toPrecision(kDigits));
        return [camera.position.toArray(), target.toArray(), [this.fov]].map((all) => all.map(short).join()).join(';');
    }

    // A tall picture shows from side to side what a wide one shows from top to bottom.
    setAspect(aspect) {
        const { camera } = this,
            halfTangent = Math.tan(MathUtils.degToRad(this.fov) / 2) / Math.min(aspect, 1);
        camera.aspect = aspect;
        camera.fov = MathUtils.radToDeg(2 * Math.atan(halfTangent));
        camera.updateProjectionMatrix();
    }

    dispose() {
        this.listening.abort();
        this.modes.orbit.dispose();
    }
}
