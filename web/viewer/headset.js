// The room in a headset: drawn for each eye where the head is, walked through by sticks and to floors that are pointed at.
// Loaded when it is entered.
import {
    BufferGeometry,
    CustomToneMapping,
    Euler,
    Group,
    Line,
    LineBasicMaterial,
    LinearSRGBColorSpace,
    Matrix4,
    NoToneMapping,
    PerspectiveCamera,
    Quaternion,
    Raycaster,
    SRGBColorSpace,
    ShaderChunk,
    Vector3,
} from 'three';
import shaders from 'phat:shaders';
import { Body, floorAt, kArrived, kWalkPerSecond } from './body.js';
import { Sticks } from './sticks.js';

// None of these was tuned on a device.
const kFrameSeconds = 0.01, // of the 14 or less that a headset has
    kEyePixels = 4e6, // of one eye
    kMinScale = 0.4; // of the sides of the headset's pictures
const kRayMilliseconds = 1, // an eye
    kLightMilliseconds = 1;
const kPointerMeters = 3,
    kStrideMeters = 0.3;
const up = new Vector3(0, 1, 0);

// A head's heading, and how far it looks up.
const anglesOf = (quaternion) => new Euler().setFromQuaternion(quaternion, 'YXZ');

// What present.frag does to the page's picture, three.js does to what it draws at once. Its own AgX, which begins with the
// primaries of Rec. 2020, has other colours.
function useToneMap() {
    const name = 'tonemapping_pars_fragment',
        empty = 'vec3 CustomToneMapping( vec3 color ) { return color; }',
        own = 'vec3 CustomToneMapping(vec3 color) { return toneMapAgx(max(color * toneMappingExposure, vec3(0.0))); }';
    ShaderChunk[name] = ShaderChunk[name].replace(empty, `${shaders['lib/tone_map.glsl']}\n${own}`);
}

export class Headset {
    // `session`: of WebXR, in immersive-vr with a local floor. `ended` is called when it is over. pre: the room is in metres.
    constructor(viewer, session, ended) {
        const { camera, walls, navigation } = viewer;
        Object.assign(this, { viewer, session, ended, sticks: new Sticks(session) });
        this.eye = new PerspectiveCamera(camera.fov, camera.aspect, camera.near, camera.far);
        this.floor = new Group(); // on which who wears the headset stands, wherever on it
        this.floor.add(this.eye);
        this.body = new Body(walls, navigation.meter);
        this.isPlaced = false;
    }

    async begin() {
        const { viewer, session, floor } = this,
            { renderer, navigation, scene } = viewer;
        navigation.jump();
        if (navigation.mode === 'orbit' && navigation.rooms.length > 0) navigation.goInside();
        navigation.current.leave();
        viewer.stop();
        scene.add(floor);
        [0, 1].forEach((i) => floor.add(this.pointerOf(renderer.xr.getController(i))));
        useToneMap();
        Object.assign(renderer, { outputColorSpace: SRGBColorSpace, toneMapping: CustomToneMapping });
        renderer.xr.setFramebufferScaleFactor(this.scale);
        renderer.setAnimationLoop((now, frame) => frame && this.tryFrame(now, frame)); // the session's frames alone
        const begun = renderer.xr.setSession(session);
        // After three.js, which listens since the line before.
        session.addEventListener('end', () => this.finish());
        session.addEventListener('select', (event) => this.goWhere(event));
        await begun;
    }

    // Of a headset's picture, so that the device draws it in time.
    get scale() {
        const { secondsPerPixel } = this.viewer;
        if (!secondsPerPixel) return 1;
        return Math.min(1, Math.max(kMinScale, Math.sqrt(kFrameSeconds / (secondsPerPixel * 2 * kEyePixels))));
    }

    // A line that shows where a controller points.
    pointerOf(controller) {
        const ends = new BufferGeometry().setFromPoints([new Vector3(), new Vector3(0, 0, -kPointerMeters)]);
        controller.clear();
        return controller.add(new Line(ends, new LineBasicMaterial({ toneMapped: false })));
    }

    tryFrame(now, frame) {
        if (this.viewer.headset !== this) return;
        try {
            this.frame(now, frame);
        } catch (error) {
            this.leave();
            this.viewer.host.failed(error);
        }
    }

    frame(now, frame) {
        const { viewer, eye } = this,
            { renderer, scene, light, exposure } = viewer,
            pose = frame.getViewerPose(renderer.xr.getReferenceSpace());
        if (!pose) return;
        this.see(pose.transform);
        if (!this.isPlaced) this.place();
        this.walk(Math.min((now - (this.previous ?? now)) / 1000, 0.1));
        this.previous = now;
        Object.assign(light, { quality: 'fast', seed: 0 });
        Object.assign(light, { reflectionMilliseconds: kRayMilliseconds, updateMilliseconds: kLightMilliseconds });
        scene.background = light.environment;
        renderer.toneMappingExposure = 2 ** exposure;
        // Other pictures that a page asks for meanwhile are not the headset's.
        renderer.xr.enabled = true;
        renderer.render(scene, eye);
        renderer.xr.enabled = false;
    }

    // Where the head is on the floor.
    see({ position, orientation }) {
        this.head = new Vector3().copy(position);
        this.turned = new Quaternion(orientation.x, orientation.y, orientation.z, orientation.w);
        this.body.eyeHeight = Math.max(this.head.y, 0.1);
    }

    get headWorld() {
        this.floor.updateMatrixWorld();
        return this.head.clone().applyMatrix4(this.floor.matrixWorld);
    }

    // The head where the page's view is, but with its feet on the floor, if there is one.
    place() {
        const { camera } = this.viewer,
            { floor, body } = this;
        this.isPlaced = true;
        floor.rotation.y = anglesOf(camera.quaternion).y - anglesOf(this.turned).y;
        this.bringHeadTo(camera.position);
        floor.position.y += body.rise(camera.position, Infinity);
    }

    walk(seconds) {
        const { right, ahead, left } = this.sticks.read();
        if (left) this.turn(left);
        const heading = anglesOf(this.turned).y + this.floor.rotation.y,
            motion = new Vector3(right, 0, -ahead).multiplyScalar(kWalkPerSecond * seconds).applyAxisAngle(up, heading);
        if (motion.length() > 0) this.step(motion, seconds);
    }

    step(motion, seconds) {
        const { floor, body } = this;
        this.bringHeadTo(body.move(this.headWorld, motion));
        floor.position.y += body.rise(this.headWorld, seconds);
    }

    bringHeadTo(place) {
        const way = place.clone().sub(this.headWorld);
        this.floor.position.add(way);
    }

    // Around the head.
    turn(radians) {
        const head = this.headWorld;
        this.floor.rotation.y += radians;
        this.bringHeadTo(head);
    }

    // To the floor that a controller, or a gaze, points at.
    goWhere({ frame, inputSource }) {
        const { floor, viewer } = this,
            space = viewer.renderer.xr.getReferenceSpace(),
            pose = frame.getPose(inputSource.targetRaySpace, space);
        if (!pose || !this.isPlaced) return;
        const ray = new Raycaster(),
            from = new Matrix4().fromArray(pose.transform.matrix).premultiply(floor.matrixWorld);
        ray.set(new Vector3().setFromMatrixPosition(from), new Vector3(0, 0, -1).transformDirection(from));
        const goal = floorAt(ray, viewer.navigation.root);
        if (goal) this.goTo(goal);
    }

    // At once, but as far as a walk would lead: up stairs, and not onto tables or through walls.
    goTo(goal) {
        for (let left = Infinity; ; ) {
            const way = goal.clone().sub(this.headWorld).setY(0),
                length = way.length();
            if (length < kArrived || length > left - kArrived) return;
            left = length;
            this.step(way.clampLength(0, kStrideMeters), Infinity);
        }
    }

    leave() {
        this.session.end().catch(() => {}); // it may be over
    }

    // The page goes on from where the head was.
    finish() {
        const { viewer, floor } = this,
            { renderer, camera, navigation } = viewer;
        floor.removeFromParent();
        floor.traverse(({ geometry, material }) => [geometry, material].forEach((part) => part?.dispose()));
        Object.assign(renderer, { outputColorSpace: LinearSRGBColorSpace, toneMapping: NoToneMapping });
        this.ended();
        if (viewer.headset !== this) return; // the room is gone
        viewer.headset = null;
        if (this.isPlaced) {
            const { x, y } = anglesOf(this.turned);
            camera.position.copy(this.headWorld);
            camera.quaternion.setFromEuler(new Euler(x, y + floor.rotation.y, 0, 'YXZ'));
            camera.updateMatrixWorld();
        }
        navigation.chooseMode();
        viewer.resize();
        viewer.viewChanged(false);
        viewer.run();
    }
}
