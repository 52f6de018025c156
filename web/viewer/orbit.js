// Orbiting the point that was ahead. Who begins inside walls stays inside: the eye is pulled in before them.
import { Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const kRadiiPerSecond = 0.4; // of the scene's sphere
const kTurnPerSecond = 1.2; // radians
// Metres.
const kBeforeSurface = 0.1,
    kFromWall = 0.15;
const kMinDistance = 0.01; // of the scene's sphere: the nearest to the point
const kDollyPerSecond = 0.8; // of the distance

// right, up, ahead; left and upward turn
export const orbitKeys = {
    w: [0, 0, 1, 0, 0],
    s: [0, 0, -1, 0, 0],
    a: [-1, 0, 0, 0, 0],
    d: [1, 0, 0, 0, 0],
    q: [0, -1, 0, 0, 0],
    e: [0, 1, 0, 0, 0],
    ArrowLeft: [0, 0, 0, 1, 0],
    ArrowRight: [0, 0, 0, -1, 0],
    ArrowUp: [0, 0, 0, 0, 1],
    ArrowDown: [0, 0, 0, 0, -1],
    '+': [0, 0, 0, 0, 0, 1],
    '-': [0, 0, 0, 0, 0, -1],
};

export class Orbit {
    constructor({ camera, canvas, walls, radius, meter, changed }) {
        Object.assign(this, { camera, walls, radius, meter, changed });
        this.controls = new OrbitControls(camera, canvas);
        this.controls.minDistance = Math.min(kMinDistance * radius, kBeforeSurface * meter);
        this.controls.enabled = false;
        this.controls.addEventListener('change', () => {
            if (!this.controls.enabled) return;
            this.stayInside();
            changed();
        });
    }

    get target() {
        return this.controls.target;
    }

    // `inside`: whether walls hold.
    enter(inside) {
        const { camera, controls, walls, meter } = this;
        const forward = camera.getWorldDirection(new Vector3()),
            ahead = walls.distance(camera.position, forward, this.radius);
        const distance = Math.max(ahead - Math.min(kBeforeSurface * meter, ahead / 10), controls.minDistance);
        controls.target.copy(camera.position).addScaledVector(forward, distance);
        Object.assign(this, { inside, reach: distance, last: distance, before: controls.target.clone() });
        controls.enabled = true;
        controls.update();
    }

    leave() {
        this.controls.enabled = false;
    }

    // A point that has passed a wall goes back, and the eye comes in, no farther than was asked for.
    stayInside() {
        if (!this.inside) return;
        const { camera, controls, walls, meter, before } = this;
        if (!walls.isFree(before, controls.target)) {
            camera.position.sub(controls.target).add(before);
            controls.target.copy(before);
        }
        before.copy(controls.target);
        const toEye = camera.position.clone().sub(controls.target),
            distance = toEye.length();
        if (Math.abs(distance - this.last) > 1e-6 * this.radius) this.reach = distance; // came nearer, or went back
        const free = walls.distance(controls.target, toEye.divideScalar(distance), this.reach + kFromWall * meter);
        this.last = Math.max(Math.min(this.reach, free - kFromWall * meter), free / 2);
        camera.position.copy(controls.target).addScaledVector(toEye, this.last);
    }

    // By keys. Returns whether the view has changed.
    advance(seconds, pressed, fast) {
        const sum = [0, 0, 0, 0, 0, 0];
        for (const key of pressed) orbitKeys[key]?.forEach((x, i) => (sum[i] += x));
        if (sum.every((x) => x === 0)) return false;
        const [right, up, ahead, left, upward, nearer] = sum,
            { camera, controls } = this;
        const step = seconds * (fast ? 4 : 1) * kRadiiPerSecond * this.radius;
        const motion = new Vector3(right, 0, -ahead).applyQuaternion(camera.quaternion);
        motion.y += up;
        camera.position.addScaledVector(motion, step);
        controls.target.addScaledVector(motion, step);
        const toEye = camera.position.clone().sub(controls.target);
        const across = new Vector3(1, 0, 0).applyQuaternion(camera.quaternion);
        toEye.applyAxisAngle(camera.up, -left * kTurnPerSecond * seconds);
        const pitched = toEye.clone().applyAxisAngle(across, -upward * kTurnPerSecond * seconds);
        if (Math.abs(pitched.y) < 0.99 * pitched.length()) toEye.copy(pitched);
        toEye.multiplyScalar(Math.exp(-nearer * kDollyPerSecond * seconds));
        camera.position.copy(controls.target).add(toEye);
        controls.update();
        return true;
    }

    dispose() {
        this.controls.dispose();
    }
}
