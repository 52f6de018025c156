// Orbit or look around by pointer and touch, fly by keys.
import { Box3, MathUtils, PerspectiveCamera, Raycaster, Sphere, Vector2, Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const kTurnPerSecond = 1.2; // radians
const kRadiiPerSecond = 0.4; // of the scene's sphere
const kHeadRadii = 1e-4; // from the eye to the centre of a turning head

export function sphereOf(root) {
    const sphere = new Box3().setFromObject(root).getBoundingSphere(new Sphere());
    sphere.radius ||= 1; // of a point
    return sphere;
}

// Of a file that has none, from the numbers that `phat web` writes into the page: eye, target, vertical field of view in
// degrees.
export function defaultCamera(numbers) {
    const [x, y, z, ...rest] = numbers.split(' ').map(Number);
    const camera = new PerspectiveCamera(rest[3]);
    camera.position.set(x, y, z);
    camera.lookAt(...rest.slice(0, 3));
    camera.updateMatrixWorld();
    return camera;
}

// Boxes that rooms consist of, from the numbers that `phat web` writes into the page: low and high corners.
function boxesOf(numbers) {
    const all = numbers.split(' ').map(Number),
        corner = (i) => new Vector3(...all.slice(i, i + 3));
    return Array.from({ length: Math.floor(all.length / 6) }, (_, i) => new Box3(corner(6 * i), corner(6 * i + 3)));
}

export class Navigation {
    // `changed` is called when the view is another one.
    constructor(camera, canvas, root, changed) {
        Object.assign(this, { camera, root, changed });
        this.rooms = boxesOf(canvas.dataset.rooms);
        this.radius = sphereOf(root).radius;
        this.metersPerSecond = kRadiiPerSecond * this.radius;
        this.controls = new OrbitControls(camera, canvas);
        this.controls.addEventListener('change', () => {
            if (this.inside) this.walk();
            changed();
        });
        this.controls.addEventListener('start', () => {
            this.held = true;
        });
        this.controls.addEventListener('end', () => {
            this.held = false;
            this.crossDoor();
        });
        this.pressed = new Set();
        canvas.addEventListener('keydown', (event) => {
            if (event.ctrlKey || event.metaKey || event.altKey) return;
            if (event.code === 'Digit0') this.goTo(this.first);
            else if (!(event.code in keys)) return;
            else this.pressed.add(event.code);
            this.fast = event.shiftKey;
            event.preventDefault();
            changed();
        });
        canvas.addEventListener('keyup', (event) => {
            this.pressed.delete(event.code);
        });
        canvas.addEventListener('blur', () => this.pressed.clear());
    }

    // From a camera of the file.
    goTo(view) {
        this.first = view;
        const { camera } = this;
        view.matrixWorld.decompose(camera.position, camera.quaternion, new Vector3());
        this.setAspect(camera.aspect);
        this.chooseCenter();
        this.changed();
    }

    isInRoom() {
        return this.rooms.some((box) => box.containsPoint(this.camera.position));
    }

    // Who has walked out of a room orbits, and who has come in turns the head; not in the middle of a drag.
    crossDoor() {
        if (!this.held && this.isInRoom() !== this.inside) this.chooseCenter();
    }

    // The point in the middle of the image is the centre of orbiting; in a room, where an orbit would lead through the
    // walls, the head turns instead.
    chooseCenter() {
        const { camera, controls } = this;
        camera.updateMatrixWorld();
        const ray = new Raycaster();
        ray.setFromCamera(new Vector2(), camera);
        const [hit] = ray.intersectObject(this.root, true);
        this.ahead = hit?.distance ?? this.radius;
        this.inside = this.isInRoom();
        const distance = this.inside ? kHeadRadii * this.radius : this.ahead;
        controls.target.copy(camera.position).addScaledVector(ray.ray.direction, distance);
        // What is under the pointer stays there: it lies behind the centre of a turning head, which turns the other way.
        controls.rotateSpeed = this.inside ? -camera.fov / 360 : 1;
        controls.panSpeed = this.ahead / distance;
        controls.update();
    }

    // What would change the distance to the centre of the head moves the eye along the view.
    walk() {
        const { camera, controls } = this,
            head = kHeadRadii * this.radius,
            toward = controls.target.clone().sub(camera.position),
            distance = toward.length();
        camera.position.addScaledVector(toward, ((1 - distance / head) * this.ahead) / distance);
        controls.target.copy(camera.position).addScaledVector(toward, head / distance);
    }

    // A tall picture shows from side to side what a wide one shows from top to bottom.
    setAspect(aspect) {
        const { camera } = this,
            halfTangent = Math.tan(MathUtils.degToRad(this.first.fov) / 2) / Math.min(aspect, 1);
        camera.aspect = aspect;
        camera.fov = MathUtils.radToDeg(2 * Math.atan(halfTangent));
        camera.updateProjectionMatrix();
    }

    // Moves by the keys that are pressed. Returns whether any is.
    fly(seconds) {
        if (this.pressed.size === 0) return false;
        const { camera, controls } = this,
            step = seconds * (this.fast ? 4 : 1);
        const offset = new Vector3(),
            turn = new Vector2();
        for (const code of this.pressed) {
            const [x, y, z, yaw, pitch] = keys[code];
            offset.add(new Vector3(x, 0, z));
            camera.position.y += y * this.metersPerSecond * step;
            controls.target.y += y * this.metersPerSecond * step;
            turn.add(new Vector2(yaw, pitch));
        }
        offset.multiplyScalar(this.metersPerSecond * step).applyQuaternion(camera.quaternion);
        camera.position.add(offset);
        controls.target.add(offset);
        // The eye turns where it is.
        const toward = controls.target.clone().sub(camera.position);
        const right = new Vector3(1, 0, 0).applyQuaternion(camera.quaternion);
        toward.applyAxisAngle(new Vector3(0, 1, 0), turn.x * kTurnPerSecond * seconds);
        const pitched = toward.clone().applyAxisAngle(right, turn.y * kTurnPerSecond * seconds);
        if (Math.abs(pitched.y) < 0.99 * pitched.length()) toward.copy(pitched);
        controls.target.copy(camera.position).add(toward);
        controls.update();
        this.crossDoor();
        return true;
    }
}

// right, up, back; left and upward turn
const keys = {
    KeyW: [0, 0, -1, 0, 0],
    KeyS: [0, 0, 1, 0, 0],
    KeyA: [-1, 0, 0, 0, 0],
    KeyD: [1, 0, 0, 0, 0],
    KeyQ: [0, -1, 0, 0, 0],
    KeyE: [0, 1, 0, 0, 0],
    Equal: [0, 0, -1, 0, 0],
    NumpadAdd: [0, 0, -1, 0, 0],
    Minus: [0, 0, 1, 0, 0],
    NumpadSubtract: [0, 0, 1, 0, 0],
    ArrowLeft: [0, 0, 0, 1, 0],
    ArrowRight: [0, 0, 0, -1, 0],
    ArrowUp: [0, 0, 0, 0, 1],
    ArrowDown: [0, 0, 0, 0, -1],
};
