// A baked room in a canvas: draws it as fast as the device can while the view moves, and ever better at rest.
import { PerspectiveCamera, Scene, Vector2 } from 'three';
import { jitterOf, prepareLights } from '../src/index.js';
import { kRelativeCost } from '../src/passes.js';
import { Navigation, sphereOf } from './navigation.js';
import { Picture } from './picture.js';
import { prepareMaterial } from './room.js';
import { StillPicture } from './still_picture.js';
import { Walls } from './walls.js';

// Pictures that a view at rest is averaged from, and while its light changes.
const kSamples = 32,
    kChangingSamples = 8;
// A moving view is drawn as 'fast', and in as many pixels as the device draws in this time; at rest a picture
// may take longer.
const kMovingSeconds = 0.04,
    kRestSeconds = 0.6;
// Of these times, what rays may take; where the rest is not enough for all pixels, there are none while a view moves.
const kMovingRaySeconds = 0.01,
    kRestRaySeconds = 0.1;
// What updates of the light may take of a moving view's picture, and the least of one at rest: there it may take
// as long as the picture does.
const kMovingLightSeconds = 0.004,
    kRestLightSeconds = 0.03;
const kNear = 0.01; // units of length
const kMinScale = 0.25,
    kScaleSteps = 8;

// 'fast', 'default' or 'high'; 'default' for anything else.
const qualityOf = (name) => (Object.hasOwn(kRelativeCost, name) ? name : 'default');

export class Viewer {
    // `settings`: exposure, in stops; quality, as BakedLight has it; rooms, as Navigation takes them; reducesMotion(). `host` is told what happens:
    // viewChanged(byUser), drawn(), failed(error).
    constructor(renderer, gltf, { exposure, quality, rooms, reducesMotion }, host) {
        Object.assign(this, {
            renderer,
            host,
            exposure,
            canvas: renderer.domElement,
            light: gltf.userData.bakedLight,
        });
        this.quality = qualityOf(quality);
        this.scene = new Scene();
        this.scene.add(gltf.scene);
        gltf.scene.updateMatrixWorld(true);
        const sphere = sphereOf(gltf.scene),
            { unitMeters } = this.light;
        this.camera = new PerspectiveCamera(
            40,
            1,
            Math.min(1e-3 * sphere.radius, kNear * unitMeters),
            50 * sphere.radius,
        );
        this.picture = new Picture(renderer);
        this.still = new StillPicture(this);
        this.lastMove = -1e9;
        this.scale = 0.5; // of the sides; until the device is known
        this.secondsPerPixel = 0; // 'fast'; 0: not known yet
        this.pending = null;
        this.headset = null; // where the room is shown in one
        this.isWhole = false; // whether the last picture showed all that is loaded
        this.light.waitsForPrograms = false;
        this.walls = new Walls(gltf.scene, this.light);
        this.navigation = new Navigation({
            camera: this.camera,
            canvas: this.canvas,
            root: gltf.scene,
            walls: this.walls,
            unitMeters,
            rooms,
            reducesMotion,
            changed: (byUser) => this.viewChanged(byUser),
        });
        this.findParts(gltf.scene);
        prepareLights(renderer, this.scene);
    }

    // The file's materials and viewpoints.
    findParts(root) {
        const materials = new Set(),
            cameras = [];
        root.traverse((object) => {
            // Those of the nodes: of a camera that several nodes have, gltf.cameras is none of theirs.
            if (object.isPerspectiveCamera) cameras.push(object);
            if (object.isMesh && object.material.isMeshStandardMaterial) materials.add(object.material);
        });
        Object.assign(this, { materials: [], asBaked: new Map(), cameras });
        materials.forEach((material) => this.addMaterial(material));
        this.navigation.viewpoints = cameras;
    }

    addMaterial(material) {
        const { roughness, metalness, color } = material;
        prepareMaterial(material, this.renderer);
        this.materials.push(material);
        this.asBaked.set(material, { roughness, metalness, color: color.clone() });
    }

    // Draws from now on, from `view` first.
    begin(view) {
        this.navigation.goTo(view);
        this.resize();
        this.resizing = new ResizeObserver(() => this.resize());
        this.resizing.observe(this.canvas);
        this.canvas.addEventListener('webglcontextrestored', () => {
            this.pending = null;
            this.drawShadows();
            this.changed();
        });
        this.run();
    }

    run() {
        this.previous = performance.now();
        this.renderer.setAnimationLoop((now) => {
            try {
                this.frame(now);
            } catch (error) {
                this.stop();
                this.host.failed(error);
            }
        });
    }

    stop() {
        this.renderer.setAnimationLoop(null);
    }

    setQuality(name) {
        this.quality = qualityOf(name);
        this.changed();
    }

    // Again where something has moved.
    drawShadows() {
        this.renderer.shadowMap.needsUpdate = true;
    }

    resize() {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        if (!width || !height || this.renderer.xr.isPresenting) return;
        const ratio = Math.min(devicePixelRatio, 1.5);
        this.renderer.setPixelRatio(this.scale * ratio);
        this.renderer.setSize(width, height, false);
        this.navigation.setAspect(width / height);
        const size = this.renderer.getDrawingBufferSize(new Vector2());
        this.picture.setSize(size.x, size.y);
        this.still.setSize(Math.floor(ratio * width), Math.floor(ratio * height));
        this.changed();
    }

    // As many pixels as can be drawn in time.
    fitScale(quality, seconds) {
        if (!this.secondsPerPixel) return;
        const { width, height } = this.picture.target,
            pixels = (width * height) / this.scale ** 2;
        const fitting = Math.sqrt(seconds / (this.secondsPerPixel * kRelativeCost[quality] * pixels));
        this.setScale(Math.min(1, Math.max(kMinScale, Math.floor(fitting * kScaleSteps) / kScaleSteps)));
    }

    setScale(scale) {
        if (scale === this.scale) return;
        this.scale = scale;
        this.resize();
    }

    // Whether the GPU has caught up. At most one frame is queued, so that the page stays responsive.
    isIdle(gl, now) {
        if (!this.pending) return true;
        const { fence, since, pixels, rows } = this.pending;
        if (gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
        gl.deleteSync(fence);
        this.pending = null;
        const seconds = (now - since - this.light.tracedMilliseconds) / 1000;
        if (pixels && seconds > 0) this.secondsPerPixel = seconds / pixels;
        if (rows) this.still.learn(rows, seconds);
        return true;
    }

    // What rays may take of the time of a picture.
    raySeconds(moving) {
        if (!moving) return kRestRaySeconds;
        const { width, height } = this.picture.target,
            left = kMovingSeconds - this.secondsPerPixel * width * height;
        return this.scale < 1 ? 0 : Math.min(Math.max(left, 0), kMovingRaySeconds);
    }

    lightSeconds(moving, quality) {
        const { width, height } = this.picture.target,
            seconds = this.secondsPerPixel * kRelativeCost[quality] * width * height;
        return moving ? kMovingLightSeconds : Math.max(seconds, kRestLightSeconds);
    }

    viewChanged(byUser = false) {
        this.lastMove = performance.now();
        this.changed();
        this.host.viewChanged(byUser);
    }

    changed() {
        this.picture.samples = 0;
        this.still.forget();
    }

    frame(now) {
        this.navigation.advance(Math.min((now - this.previous) / 1000, 0.1));
        this.previous = now;
        const gl = this.renderer.getContext();
        if (gl.isContextLost() || !this.isIdle(gl, now)) return;
        const moving = now - this.lastMove < 150 || !this.secondsPerPixel;
        const wasWhole = this.isWhole;
        if (!wasWhole) this.changed();
        if (!this.light.isSettled) this.still.forget();
        if (!moving && wasWhole && this.still.isDue) {
            if (this.still.isDone) return;
            this.awaitGpu(now, { rows: this.still.advance() });
            if (!this.still.hasBetterPoster) this.host.drawn();
            return;
        }
        if (!moving && this.light.isSettled && this.picture.samples >= kSamples) return;
        const quality = moving ? 'fast' : this.quality;
        if (moving) this.settle();
        if (this.picture.samples === 0 || moving)
            this.fitScale(quality, moving ? kMovingSeconds : kRestSeconds);
        this.light.reflectionMilliseconds = 1000 * this.raySeconds(moving);
        this.light.updateMilliseconds = 1000 * this.lightSeconds(moving, quality);
        this.addSample(quality);
        this.present();
        const { width, height } = this.picture.target;
        // Of 'fast'. Time in which programs are compiled, or light is made, says nothing.
        const isMeasured = wasWhole && this.isWhole && this.light.isSettled;
        this.awaitGpu(now, { pixels: isMeasured ? width * height * kRelativeCost[quality] : 0 });
        if (!this.still.hasBetterPoster) this.host.drawn();
    }

    awaitGpu(now, about) {
        const gl = this.renderer.getContext();
        this.pending = { fence: gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0), since: now, ...about };
        gl.flush();
    }

    // The picture of a moving view is not part of the mean at rest.
    settle() {
        clearTimeout(this.settled);
        this.settled = setTimeout(() => this.changed(), 160);
    }

    addSample(quality, count = kSamples) {
        const { camera, light, picture } = this,
            { width, height } = picture.target;
        this.drawn = picture.samples === 0 ? 0 : this.drawn + 1;
        Object.assign(light, { quality, seed: this.drawn });
        const [x, y] = jitterOf(this.drawn % count, count);
        camera.setViewOffset(width, height, -x, y, width, height);
        this.scene.background = light.environment;
        const traced = light.tracedMilliseconds > 0;
        picture.add(this.scene, camera, light.isSettled ? Infinity : kChangingSamples);
        // A mean is of pictures whose reflections were found in one way.
        this.isWhole = light.isWhole && light.tracedMilliseconds > 0 === traced;
    }

    present() {
        const shown = this.still.isShown ? this.still.picture : this.picture;
        if (shown.samples > 0) shown.present(this.exposure);
    }

    // Returns the canvas, in which a picture is until the browser shows the next one.
    presentSome() {
        if (this.picture.samples === 0) this.addSample(this.quality);
        this.present();
        return this.canvas;
    }

    // For scripts: the mean of `count` pictures, linear radiance as RGBA floats, row 0 at the bottom.
    render(count, quality = this.quality) {
        this.setScale(1);
        this.changed();
        this.light.waitsForPrograms = true;
        for (let i = 0; i < count; ++i) this.addSample(quality, count);
        this.light.waitsForPrograms = false;
        return this.picture.read();
    }

    // Stops, and frees what is on the GPU. The canvas cannot be used again.
    dispose() {
        const { headset } = this;
        this.headset = null;
        headset?.leave();
        this.stop();
        clearTimeout(this.settled);
        this.resizing?.disconnect();
        this.still.dispose();
        this.navigation.dispose();
        this.light.detach();
        this.renderer.dispose();
        this.renderer.forceContextLoss();
    }
}
