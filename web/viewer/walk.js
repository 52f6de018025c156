// Walking: the head turns by dragging, the feet stay on the floor, walls hold.
import { Euler, MathUtils, Vector3 } from 'three';
import { Body, floorAt, kArrived, kWalkPerSecond } from './body.js';
import { kTapPixels, rayThrough } from './taps.js';

// Metres.
const kEyeHeight = 1.6,
    kLowestEye = 1, // an eye that is lower is the author's choice, and stays there
    kHighestEye = 2,
    kGoPerSecond = 3, // to where the floor was tapped
    kPerWheelPixel = 0.003,
    kPerPinch = 2; // for fingers that get twice as far apart
const kTurnPerSecond = 1.2; // radians
const kMaxPitch = 1.5;
const kTapMilliseconds = 300;

// right, ahead; left and upward turn
export const walkKeys = {
    w: [0, 1, 0, 0],
    s: [0, -1, 0, 0],
    a: [-1, 0, 0, 0],
    d: [1, 0, 0, 0],
    ArrowUp: [0, 1, 0, 0],
    ArrowDown: [0, -1, 0, 0],
    '+': [0, 1, 0, 0],
    '-': [0, -1, 0, 0],
    ArrowLeft: [0, 0, 1, 0],
    ArrowRight: [0, 0, -1, 0],
    q: [0, 0, 1, 0],
    e: [0, 0, -1, 0],
    PageUp: [0, 0, 0, 1],
    PageDown: [0, 0, 0, -1],
};

export class Walk {
    // `changed` is called when the view is another one.
    constructor({ camera, canvas, root, walls, meter, reducesMotion, changed }, signal) {
        Object.assign(this, { camera, canvas, root, meter, reducesMotion, changed, body: new Body(walls, meter) });
        this.enabled = false;
        this.goesToTaps = true;
        this.pointers = new Map();
        const on = (name, handle) =>
            canvas.addEventListener(name, (event) => this.enabled && handle(event), { signal, passive: false });
        on('pointerdown', (event) => this.press(event));
        on('pointermove', (event) => this.drag(event));
        on('pointerup', (event) => this.lift(event));
        on('pointercancel', ({ pointerId }) => this.pointers.delete(pointerId));
        on('wheel', (event) => {
            event.preventDefault();
            this.stride(-event.deltaY * kPerWheelPixel);
        });
    }

    // From where the camera is.
    enter() {
        this.enabled = true;
        this.goal = null;
        this.pointers.clear();
        const { meter, camera } = this,
            euler = new Euler().setFromQuaternion(camera.quaternion, 'YXZ');
        this.yaw = euler.y;
        this.pitch = MathUtils.clamp(euler.x, -kMaxPitch, kMaxPitch);
        const height = this.body.heightOf(camera.position);
        this.body.eyeHeight = height > kHighestEye * meter ? kEyeHeight * meter : height;
        this.staysUp = height < kLowestEye * meter;
    }

    leave() {
        this.enabled = false;
        this.goal = null;
    }

    turn(left, up) {
        this.yaw += left;
        this.pitch = MathUtils.clamp(this.pitch + up, -kMaxPitch, kMaxPitch);
        this.camera.quaternion.setFromEuler(new Euler(this.pitch, this.yaw, 0, 'YXZ'));
        this.changed();
    }

    // Metres to the right and ahead, level. Returns whether that was possible.
    step(right, ahead) {
        const { camera } = this,
            before = camera.position.clone();
        const motion = new Vector3(right, 0, -ahead).multiplyScalar(this.meter).applyAxisAngle(camera.up, this.yaw);
        camera.position.copy(this.body.move(before, motion));
        this.changed();
        return camera.position.distanceTo(before) > 0.2 * motion.length();
    }

    // By hand: ends a walk to a goal.
    stride(meters) {
        this.goal = null;
        this.step(0, meters);
        this.settle(Infinity);
    }

    // The feet come down, or up, to the floor. Returns whether they did.
    settle(seconds) {
        const { camera, body } = this,
            rise = this.staysUp ? 0 : body.rise(camera.position, seconds);
        if (rise === 0) return false;
        camera.position.y += rise;
        this.changed();
        return true;
    }

    press(event) {
        this.canvas.setPointerCapture(event.pointerId);
        this.goal = null;
        const { clientX: x, clientY: y, pointerId, button, timeStamp } = event;
        this.tap = this.pointers.size === 0 && button === 0 ? { x, y, timeStamp } : null;
        this.pointers.set(pointerId, { x, y });
    }

    // With one finger the room follows it; with two, that is their middle, and what their distance does is walking.
    drag({ clientX, clientY, pointerId }) {
        const last = this.pointers.get(pointerId);
        if (!last) return;
        const [dx, dy] = [clientX - last.x, clientY - last.y],
            others = [...this.pointers].filter(([id]) => id !== pointerId).map(([, at]) => at);
        const apart = ({ x, y }) => Math.max(1, Math.hypot(x - others[0].x, y - others[0].y));
        const radians = MathUtils.degToRad(this.camera.fov) / this.canvas.clientHeight / this.pointers.size;
        this.pointers.set(pointerId, { x: clientX, y: clientY });
        if (Math.hypot(clientX - this.tap?.x, clientY - this.tap?.y) > kTapPixels) this.tap = null;
        this.turn(dx * radians, dy * radians);
        if (others.length === 1)
            this.stride(kPerPinch * Math.log2(apart({ x: clientX, y: clientY }) / apart(last)));
    }

    lift({ pointerId, timeStamp }) {
        if (!this.pointers.delete(pointerId)) return;
        if (this.goesToTaps && timeStamp - this.tap?.timeStamp < kTapMilliseconds) this.goTo(this.tap);
        this.tap = null;
    }

    // To the floor that was tapped.
    goTo({ x, y }) {
        this.goal = floorAt(rayThrough({ clientX: x, clientY: y }, this.canvas, this.camera), this.root);
        while (this.reducesMotion() && this.approach(1 / kGoPerSecond));
    }

    // Goes on toward the goal. Returns whether it does.
    approach(seconds) {
        const { goal, camera, meter } = this;
        if (!goal) return false;
        const way = goal.clone().sub(camera.position).setY(0),
            meters = Math.min(way.length() / meter, kGoPerSecond * seconds);
        way.applyAxisAngle(camera.up, -this.yaw).setLength(meters);
        if (!this.step(way.x, -way.z) || goal.clone().sub(camera.position).setY(0).length() < kArrived * meter)
            this.goal = null;
        this.settle(this.goal ? seconds : Infinity);
        return Boolean(this.goal);
    }

    // By keys, and to a goal. Returns whether the view has changed.
    advance(seconds, pressed, fast) {
        if (this.goal) return this.approach(seconds) || true;
        const sum = [0, 0, 0, 0];
        for (const key of pressed) walkKeys[key]?.forEach((x, i) => (sum[i] += x));
        const [right, ahead, left, up] = sum;
        if (left || up) this.turn(left * kTurnPerSecond * seconds, up * kTurnPerSecond * seconds);
        const meters = kWalkPerSecond * seconds * (fast ? 2 : 1);
        this.walking = Boolean(right || ahead) && (this.step(right * meters, ahead * meters) || true);
        this.walking ||= this.isSettling;
        this.isSettling = this.walking && this.settle(seconds);
        return Boolean(this.walking || left || up);
    }
}
