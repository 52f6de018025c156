// Light that follows the lamps of a room, and what moves in it. Few rooms need it: it is loaded when BakedLight.lights is
// first read.
import { canLookUp, readPayload } from './file.js';
import { lampsOf } from './lamps.js';
import { LightRounds } from './light_rounds.js';
import { MovedSurfaces, Motion } from './motion.js';
import { findTexelPoints } from './texel_points.js';

const kSliceMilliseconds = 8;

// What a generator returns; the page may draw between slices of its steps.
async function inSlices(steps) {
    for (let since = performance.now(); ; ) {
        const { done, value } = steps.next();
        if (done) return value;
        if (performance.now() - since < kSliceMilliseconds) continue;
        await new Promise((next) => {
            setTimeout(next);
        });
        since = performance.now();
    }
}

// One sentence, or nothing.
function lackOf({ bvh, indirect, area }) {
    if (!bvh) return 'the file has no trees for rays';
    if (!canLookUp(indirect) || (area.layers.length > 0 && !canLookUp(area)))
        return 'its PHATexels are in no order by which they are found';
    return null;
}

export class LightUpdates {
    // `light`: a BakedLight. Throws where the file lacks what is needed.
    constructor(light, parser, description) {
        const lack = lackOf(description);
        if (lack) throw new Error(`the light of this room stays as it was baked: ${lack}`);
        Object.assign(this, { light, parser, description });
        const { surfaces, atlas } = light.bake,
            { drawRanges } = surfaces;
        this.lamps = lampsOf(light.root, { drawRanges, hasArea: Boolean(atlas.areaIrradiance) }, () => this.noteChange());
        this.motion = new Motion(light.bake.surfaces, light.bake.atlas);
        this.changes = 0; // of lamps and places; 0: nothing is followed yet
        this.points = null; // TexelPoints, once a lamp has been set
        this.failure = null;
        this.last = null; // LightRounds that were drawn last
    }

    noteChange() {
        if (this.light.disposed) return;
        ++this.changes;
        this.preparing ??= this.prepare().catch((error) => this.fail(error));
    }

    fail(error) {
        this.failure = error;
        console.warn(`The light stays as it was: ${error.message}`);
        this.light.onProgress?.();
    }

    async prepare() {
        const { light, parser, description } = this,
            { surfaces, atlas } = light.bake,
            bytes = Math.ceil((atlas.width * atlas.height) / 8);
        const covered = await readPayload(
            parser,
            description.atlas.covered,
            Uint8Array,
            bytes,
            'the list of covered texels',
        );
        await light.ready;
        await light.loadTrees();
        if (light.disposed) return;
        if (!light.bake.trees) throw new Error('its trees for rays cannot be read');
        const points = await inSlices(findTexelPoints(surfaces, atlas, covered));
        if (light.disposed) return;
        this.points = points;
        light.onProgress?.();
    }

    // Before a picture is drawn by `passes`. Leaves WebGL's state to the caller.
    follow(passes, view) {
        const { light, points } = this;
        light.updatedMilliseconds = 0;
        this.followMotion(passes);
        if (!points || this.failure || light.progress < 1) return;
        try {
            this.last = passes.lightRounds ??= new LightRounds(passes, points);
            this.last.follow(this, view);
            light.updatedMilliseconds = this.last.milliseconds;
        } catch (error) {
            this.fail(error);
        }
    }

    // Shows what is elsewhere now, whatever becomes of its light.
    followMotion(passes) {
        const { light, motion } = this;
        if (this.changes === 0) return;
        if (motion.update(light.root)) ++this.changes;
        passes.moved ??= new MovedSurfaces(passes, motion);
        passes.moved.show();
        if (light.bake.trees) passes.moved.pose(passes.rays.sceneOf(light));
    }

    get isSettled() {
        if (this.changes === 0 || this.failure) return true;
        return this.last?.changes === this.changes && this.last.isSettled;
    }

    dispose() {
        this.lamps.forEach((lamp) => lamp.reset());
    }
}
