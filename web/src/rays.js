// Whether a picture's reflections are traced, by how many rays, and what that takes.
import { PassTimer } from './pass_timer.js';
import { isGlass } from './material.js';
import { costAfter, costFromLookup, kMaxLevel, levelFor, raysOf } from './ray_budget.js';

export class Rays {
    constructor(gl, renderer, noVertices) {
        Object.assign(this, { gl, renderer, noVertices });
        this.timer = new PassTimer(gl);
        this.programs = null;
        this.scene = null;
        this.cost = 0; // see levelFor; 0: not known yet
        this.level = 0; // of the picture that is being drawn
        this.isAwaited = false; // whether what rays need is on its way
    }

    // Chooses the level of the next picture. `light`: a BakedLight; `pixels`: of the picture; `features`: of RayPrograms.
    choose(light, pixels, features) {
        this.learn();
        // A measurement of all passes has queries of its own, which must not overlap with these.
        this.isTimed = !light.clock;
        const { reflections, reflectionMilliseconds: milliseconds } = light;
        const isBounded = reflections === 'auto' && milliseconds < Infinity;
        let wanted = 0;
        if (reflections !== 'lookup' && light.canTrace && light.progress === 1)
            wanted = !isBounded ? kMaxLevel : this.cost > 0 ? this.levelWithin(milliseconds, pixels) : 0;
        const isReady = wanted > 0 && this.prepare(light, features, !isBounded);
        this.isAwaited = wanted > 0 && !isReady && light.canTrace;
        this.level = isReady ? wanted : 0;
        this.pixels = pixels;
        if (this.level === 0 && !this.isAwaited) this.cost = costAfter(this.cost, { level: 0 });
    }

    levelWithin(milliseconds, pixels) {
        return levelFor({ cost: this.cost, pixels, milliseconds, last: this.level });
    }

    // What parts took that have been measured since.
    learn() {
        const measured = this.timer.take();
        if (!measured) return;
        const { about, milliseconds } = measured;
        if (about.level > 0) this.cost = costAfter(this.cost, { ...about, milliseconds });
        else if (this.cost === 0) this.cost = costFromLookup({ ...about, milliseconds });
    }

    // Whether all is there; begins to load and to compile what is not.
    prepare(light, features, mayWait) {
        const { trees, tracing, surfaces } = light.bake;
        if (!trees) {
            light.loadTrees();
            return false;
        }
        const hasOpacity = trees.firstTransparent < trees.order.length,
            hasGlass = surfaces.drawRanges.some(({ mesh }) => isGlass(mesh.material));
        const hasSky = Boolean(light.environment);
        if (hasGlass !== this.hasGlass || hasSky !== this.hasSky) this.dropPrograms();
        Object.assign(this, { hasGlass, hasSky });
        this.programs ??= new tracing.RayPrograms(this.gl, { ...features, hasOpacity, hasGlass, hasSky });
        return (mayWait && light.waitsForPrograms) || this.programs.isReady();
    }

    // Around the lookup, until rays are traced: how fast a device is shows before anything is compiled for them.
    beginLookup(relativeCost) {
        if (this.cost === 0 && this.isTimed) this.timer.begin({ level: 0, pixels: this.pixels, relativeCost });
    }

    endLookup() {
        this.timer.end();
    }

    // pre: the level is above 0. `frame`: see RayPass.
    passOf(light, frame) {
        return new light.bake.tracing.RayPass({
            gl: this.gl,
            noVertices: this.noVertices,
            programs: this.programs,
            scene: this.sceneOf(light),
            rays: raysOf(this.level),
            seed: light.seed,
            ...frame,
        });
    }

    // What rays meet, as it is now. pre: the trees are there.
    sceneOf(light) {
        this.scene ??= new light.bake.tracing.RayScene(this.gl, this.renderer, light.bake, this.noVertices);
        this.scene.update(light);
        return this.scene;
    }

    trace(pass) {
        if (this.isTimed) this.timer.begin({ level: this.level, pixels: this.pixels });
        pass.trace();
        this.timer.end();
    }

    // About how long the rays of the last picture took; 0: there were none.
    get milliseconds() {
        return this.level > 0 ? Math.max(this.cost * this.pixels * 2 ** (this.level - 1), 1e-3) : 0;
    }

    // They depend on the materials' coats, and on the layers of PHATexels.
    dropPrograms() {
        this.programs?.dispose();
        this.programs = null;
    }

    dispose() {
        this.dropPrograms();
        this.scene?.dispose();
        this.scene = null;
        this.timer.dispose();
    }
}
