// Times of the passes of a frame while the view moves: what the page shows when it is asked for with ?bench.
// twin: src/cli/frame_bench.cpp
import { MathUtils, Quaternion, Vector3 } from 'three';

// twin: src/cli/frame_bench.cpp
const kWarmUpFrames = 4,
    kSwingDegrees = 20,
    kSwayUnits = 0.1,
    kMinPeriod = 16; // frames
const kFrames = 32,
    kMaxFrames = 10_000;

// How many frames `?bench` or `?bench=N` asks for.
export function framesAsked(search) {
    const count = Math.round(Number(new URLSearchParams(search).get('bench')));
    return count >= 1 && count <= kMaxFrames ? count : kFrames;
}

// The frame's time by pass, from the GPU's queries, of which each ends where the next one begins.
class QueryClock {
    name = 'gpu';

    constructor(gl, extension) {
        Object.assign(this, { gl, extension });
    }

    restart() {
        this.runs = [];
        this.begin();
    }

    begin() {
        this.query = this.gl.createQuery();
        this.gl.beginQuery(this.extension.TIME_ELAPSED_EXT, this.query);
    }

    ended(pass) {
        this.gl.endQuery(this.extension.TIME_ELAPSED_EXT);
        this.runs.push({ pass, query: this.query });
        this.begin();
    }

    // [pass, milliseconds] of each run; none if the GPU was interrupted.
    async times() {
        const { gl, extension, runs } = this;
        gl.endQuery(extension.TIME_ELAPSED_EXT);
        const last = this.query; // what follows the last pass
        while (!gl.getQueryParameter(last, gl.QUERY_RESULT_AVAILABLE)) {
            if (gl.isContextLost()) throw new Error('the GPU was lost');
            await new Promise((done) => setTimeout(done, 1));
        }
        const valid = !gl.getParameter(extension.GPU_DISJOINT_EXT);
        const times = runs.map(({ pass, query }) => [pass, gl.getQueryParameter(query, gl.QUERY_RESULT) * 1e-6]);
        for (const query of [last, ...runs.map((run) => run.query)]) gl.deleteQuery(query);
        return valid ? times : [];
    }
}

// The same by the clock, where there are no queries: it waits for the GPU at the end of each pass.
class WaitingClock {
    name = 'clock';

    constructor(finish) {
        this.finish = finish;
    }

    restart() {
        this.runs = [];
        this.since = performance.now();
    }

    ended(pass) {
        this.finish();
        const now = performance.now();
        this.runs.push([pass, now - this.since]);
        this.since = now;
    }

    times() {
        return this.runs;
    }
}

// A function that returns when the GPU has done all it was told. Browsers' gl.finish() does not wait; reading a pixel
// does.
function finisherOf(gl) {
    const texture = gl.createTexture(),
        framebuffer = gl.createFramebuffer(),
        pixel = new Uint8Array(4);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, 1, 1);
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    return () => {
        const before = gl.getParameter(gl.READ_FRAMEBUFFER_BINDING);
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, framebuffer);
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, before);
    };
}

// twin: src/core/base/median.h
function medianOf(values) {
    const sorted = values.toSorted((a, b) => a - b);
    return sorted[Math.floor(sorted.length / 2)];
}

// Tenths of a microsecond are more than a clock knows.
const rounded = (milliseconds) => Math.round(milliseconds * 1e4) / 1e4;

// Sums of the frame's runs by pass.
function byPass(times) {
    const sums = new Map();
    for (const [pass, milliseconds] of times) sums.set(pass, (sums.get(pass) ?? 0) + milliseconds);
    return sums;
}

async function measure(viewer, clock, finish, count) {
    const { camera, light } = viewer,
        first = { eye: camera.position.clone(), turn: camera.quaternion.clone() },
        right = new Vector3(1, 0, 0).applyQuaternion(first.turn).multiplyScalar(kSwayUnits * light.unitMeters),
        up = new Vector3(0, 1, 0),
        frames = [];
    for (let i = -kWarmUpFrames; i < count; ++i) {
        const side = Math.sin((2 * Math.PI * (i + 1 / 3)) / Math.max(count, kMinPeriod)),
            swing = new Quaternion().setFromAxisAngle(up, MathUtils.degToRad(kSwingDegrees) * side);
        camera.quaternion.multiplyQuaternions(swing, first.turn);
        camera.position.copy(first.eye).addScaledVector(right, side);
        viewer.changed();
        finish();
        const start = performance.now();
        clock.restart();
        viewer.addSample(viewer.quality, 1);
        clock.ended('three.js'); // its own drawing of the surfaces
        viewer.present();
        clock.ended('present');
        finish();
        const milliseconds = performance.now() - start,
            passes = byPass(await clock.times());
        if (i >= 0 && passes.size > 0) frames.push({ milliseconds, passes });
    }
    camera.quaternion.copy(first.turn);
    camera.position.copy(first.eye);
    return frames;
}

function describeGpu(gl) {
    const names = gl.getExtension('WEBGL_debug_renderer_info');
    return { gpu: gl.getParameter(names?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER), driver: gl.getParameter(gl.VERSION) };
}

// What `phat bench` prints, of the page's passes. pre: all is loaded.
export async function bench(viewer, count) {
    const { renderer, picture, light } = viewer,
        gl = renderer.getContext(),
        queries = gl.getExtension('EXT_disjoint_timer_query_webgl2'),
        finish = finisherOf(gl),
        clock = queries ? new QueryClock(gl, queries) : new WaitingClock(finish);
    renderer.resetState();
    viewer.stop();
    viewer.setScale(1);
    Object.assign(light, { clock, waitsForPrograms: true });
    let frames;
    try {
        frames = await measure(viewer, clock, finish, count);
    } finally {
        Object.assign(light, { clock: null, waitsForPrograms: false });
        viewer.changed();
        viewer.run();
    }
    if (frames.length === 0) throw new Error('the GPU was interrupted in each frame');
    const passes = [...new Set(frames.flatMap((frame) => [...frame.passes.keys()]))],
        median = (of) => rounded(medianOf(frames.map(of)));
    return {
        program: 'phat web',
        ...describeGpu(gl),
        scene: document.title,
        texels: light.bake.atlas.width * light.bake.atlas.height,
        width: picture.target.width,
        height: picture.target.height,
        reflections: light.reflections,
        quality: viewer.quality,
        frames: frames.length,
        timer: clock.name,
        passMilliseconds: Object.fromEntries(passes.map((pass) => [pass, median((frame) => frame.passes.get(pass) ?? 0)])),
        gpuMilliseconds: median((frame) => [...frame.passes.values()].reduce((a, b) => a + b)),
        frameMilliseconds: median((frame) => frame.milliseconds),
    };
}
