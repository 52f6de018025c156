// The page that `phat web` writes: a baked room to walk through.
import { LinearSRGBColorSpace, PerspectiveCamera, Scene, ShaderChunk, Vector2, WebGLRenderer } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { PhatexturesExtension, isSupported, jitterOf, prepareLights } from '../src/index.js';
import { chainShader } from '../src/hooks.js';
import { kRelativeCost } from '../src/passes.js';
import { Navigation, defaultCamera, sphereOf } from './navigation.js';
import { createPanel } from './panel.js';
import { Picture } from './picture.js';
import { StillPicture } from './still_picture.js';

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

const { sayFailure } = globalThis; // of begin.js
const element = (id) => document.getElementById(id);
const canvas = element('view');

function say(text) {
    element('message').textContent = text;
    element('message').hidden = text === '';
}

function createRenderer(context) {
    if (!isSupported(context)) throw new Error('This room needs WebGL 2.');
    const renderer = new WebGLRenderer({ canvas, context });
    renderer.outputColorSpace = LinearSRGBColorSpace; // present.frag encodes
    renderer.shadowMap.autoUpdate = false;
    return renderer;
}

// Four things that three.js does to punctual light, and glTF and hence the bake do not: a highlight is blunted where
// normals turn within a pixel (here many pictures are averaged), and brightened on rough metals for light that would
// be reflected twice; a light nearer than 10 cm counts as that far; and spots have another profile.
function keepToGltf(material) {
    const edits = [
        ['lights_physical_fragment', /.* \+= geometryRoughness;/g, ''],
        [
            'lights_pars_begin',
            'pow( lightDistance, decayExponent ), 0.01',
            'pow( lightDistance, decayExponent ), 1e-30',
        ],
        [
            'lights_pars_begin',
            'smoothstep( coneCosine, penumbraCosine, angleCosine )',
            'pow2( saturate( ( angleCosine - coneCosine ) / max( penumbraCosine - coneCosine, 1e-3 ) ) )',
        ],
        ['lights_fragment_begin', /(multiScatteringCompensation =).*;/g, '$1 vec3(1.0);'],
    ];
    chainShader(material, 'keepToGltf', (shader) => {
        for (const [name] of edits)
            shader.fragmentShader = shader.fragmentShader.replace(`#include <${name}>`, ShaderChunk[name]);
        for (const [, pattern, by] of edits) shader.fragmentShader = shader.fragmentShader.replaceAll(pattern, by);
    });
}

// With ?quality=fast and the like.
function qualityAsked() {
    const asked = new URLSearchParams(location.search).get('quality');
    return Object.hasOwn(kRelativeCost, asked) ? asked : 'default';
}

function load(url, onProgress) {
    const loader = new GLTFLoader();
    loader.register((parser) => new PhatexturesExtension(parser));
    return loader.loadAsync(url, onProgress);
}

class Viewer {
    constructor(renderer, gltf) {
        Object.assign(this, {
            renderer,
            quality: qualityAsked(),
            exposure: Number(canvas.dataset.exposure),
            light: gltf.userData.bakedLight,
        });
        this.scene = new Scene();
        this.scene.add(gltf.scene);
        gltf.scene.updateMatrixWorld(true);
        const sphere = sphereOf(gltf.scene);
        this.camera = new PerspectiveCamera(
            40,
            1,
            Math.min(1e-3 * sphere.radius, kNear * this.light.unitMeters),
            50 * sphere.radius,
        );
        this.picture = new Picture(renderer);
        this.still = new StillPicture(this);
        this.lastMove = -1e9;
        this.scale = 0.5; // of the sides; until the device is known
        this.secondsPerPixel = 0; // 'fast'; 0: not known yet
        this.pending = null;
        this.isWhole = false; // whether the last picture showed all that is loaded
        this.light.waitsForPrograms = false;
        this.navigation = new Navigation(this.camera, canvas, gltf.scene, () => this.viewChanged());
        const materials = new Set(),
            cameras = [];
        gltf.scene.traverse((object) => {
            // Those of the nodes: of a camera that several nodes have, gltf.cameras is none of theirs.
            if (object.isPerspectiveCamera) cameras.push(object);
            if (object.isMesh && object.material.isMeshStandardMaterial) materials.add(object.material);
        });
        const anisotropy = Math.min(8, renderer.capabilities.getMaxAnisotropy()); // twin: mostAnisotropy
        for (const material of materials) {
            for (const texture of Object.values(material))
                if (texture?.isTexture) Object.assign(texture, { anisotropy });
            keepToGltf(material);
        }
        prepareLights(renderer, this.scene);
        createPanel(
            this,
            [...materials],
            cameras,
            (camera) => this.navigation.goTo(camera),
            () => this.changed(),
        );
        element('quality').value = this.quality;
        this.navigation.goTo(cameras[0] ?? defaultCamera(canvas.dataset.camera));
        this.resize();
        new ResizeObserver(() => this.resize()).observe(canvas);
        canvas.addEventListener('webglcontextrestored', () => {
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
                sayFailure(`The room cannot be drawn: ${error.message}`);
                console.error(error);
            }
        });
    }

    stop() {
        this.renderer.setAnimationLoop(null);
    }

    // Again where something has moved.
    drawShadows() {
        this.renderer.shadowMap.needsUpdate = true;
    }

    resize() {
        const { clientWidth: width, clientHeight: height } = canvas;
        if (!width || !height) return;
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

    viewChanged() {
        this.lastMove = performance.now();
        this.changed();
    }

    changed() {
        this.picture.samples = 0;
        this.still.forget();
    }

    frame(now) {
        if (this.navigation.fly(Math.min((now - this.previous) / 1000, 0.1))) this.viewChanged();
        this.previous = now;
        const gl = this.renderer.getContext();
        if (gl.isContextLost() || !this.isIdle(gl, now)) return;
        const moving = now - this.lastMove < 150 || !this.secondsPerPixel;
        const wasWhole = this.isWhole;
        if (!wasWhole) this.changed();
        if (!this.light.isSettled) this.still.forget();
        if (!moving && wasWhole && this.still.isDue) {
            if (!this.still.isDone) this.awaitGpu(now, { rows: this.still.advance() });
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
        if (!this.still.hasBetterPoster) element('poster').hidden = true;
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

    // For scripts: the mean of `count` pictures, linear radiance as RGBA floats, row 0 at the bottom.
    render(count, quality = this.quality) {
        this.setScale(1);
        this.changed();
        this.light.waitsForPrograms = true;
        for (let i = 0; i < count; ++i) this.addSample(quality, count);
        this.light.waitsForPrograms = false;
        return this.picture.read();
    }
}

// With ?bench, once all is loaded.
async function showBench(viewer) {
    if (!new URLSearchParams(location.search).has('bench')) return;
    element('status').textContent = 'Measuring.';
    try {
        const { bench, framesAsked } = await import('./bench.js'),
            text = JSON.stringify(await bench(viewer, framesAsked(location.search)), null, 2);
        console.log(text);
        element('bench').textContent = text;
        element('bench').hidden = false;
    } catch (error) {
        say(`This device could not be measured: ${error.message}`);
        console.error(error);
    }
}

async function start() {
    const { room } = canvas.dataset,
        context = canvas.getContext('webgl2', { antialias: false, powerPreference: 'high-performance' });
    try {
        const renderer = createRenderer(context);
        const progress = element('progress');
        const gltf = await load(room, ({ loaded, total }) => {
            if (total) progress.value = loaded / total / 2;
        });
        const viewer = (globalThis.viewer = new Viewer(renderer, gltf));
        element('status').textContent = 'Reflections are still to come.';
        viewer.light.onProgress = () => {
            progress.value = 0.5 + viewer.light.progress / 2;
            viewer.changed();
        };
        await viewer.light.ready;
        if (gltf.animations[0] || gltf.parser.json.nodes.some(({ extras }) => extras?.phat?.movable))
            viewer.moves = new (await import('./moves.js')).Moves(viewer, gltf);
        await showBench(viewer);
        element('loading').hidden = true;
    } catch (error) {
        console.error(error);
        const general = `The room could not be loaded: ${error.message}`,
            cause = import('./failure.js').then(({ causeOf }) => causeOf({ error, room, context }));
        sayFailure(await cause.catch(() => general));
    }
}

globalThis.viewerBegan = true;
start();
