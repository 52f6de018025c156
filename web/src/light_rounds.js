// The light of one renderer's passes, made anew while pictures are drawn.
// twin: src/viewer/light_rounds.cpp.
import { BlockOrder } from './block_order.js';
import { LightPrograms, LightUpdatePass, kGuided, kStored } from './light_update_pass.js';
import { PassTimer } from './pass_timer.js';

// Irradiance is filtered so many times while all blocks are made once.
const kFiltersPerPass = 4;
// Blocks of a picture until it is known how long they take, and how many more of them the next one may have.
const kFirstBlocks = 4,
    kMaxGrowth = 2;

export class LightRounds {
    // `points`: TexelPoints.
    constructor(passes, points) {
        Object.assign(this, { passes, points });
        this.order = new BlockOrder(points.blocks);
        this.timer = new PassTimer(passes.gl);
        this.changes = 0; // that are known here, see LightUpdates
        this.revision = 0; // of the RayScene
        this.moved = 0; // revision of the Motion
        this.number = 0; // of the round
        this.perPicture = kFirstBlocks;
        this.unfiltered = 0; // blocks that were made since irradiance was last filtered
        this.filter = null; // in progress
        this.milliseconds = 0;
        this.pass = null; // once its programs are compiled
    }

    // Does a picture's part of the work. pre: what has moved is shown.
    follow({ light, motion, changes }, view) {
        const scene = this.passes.rays.sceneOf(light),
            { revision } = scene;
        if (this.changes !== changes || this.revision !== revision) this.order.noteChange();
        Object.assign(this, { changes, revision, milliseconds: 0 });
        if (this.isSettled) return;
        if (!this.isReady(scene, light)) return;
        this.move(motion);
        this.learn(light.updateMilliseconds);
        this.trace(scene, view, light);
        this.advanceFilter(light.updateMilliseconds === Infinity);
        if (this.isSettled) this.pass.bounds.find(scene.brightest);
    }

    get isSettled() {
        return this.order.isSettled && !this.filter && this.unfiltered === 0;
    }

    // Whether the programs are compiled, which are others where there are other layers of PHATexels.
    isReady(scene, light) {
        if (this.pass) return true;
        const { gl, programs } = this.passes,
            features = { defines: programs.defines, scrambles: programs.scrambles, hasOpacity: Boolean(scene.opacity) };
        this.programs ??= new LightPrograms(gl, features);
        if (!light.waitsForPrograms && !this.programs.isReady()) return false;
        this.begin();
        return true;
    }

    // From now on pictures show what is made here.
    begin() {
        const { passes } = this,
            { gl, atlas } = passes;
        this.pass = new LightUpdatePass(passes, this.points, this.programs);
        Array.from(this.pass.filter());
        gl.deleteTexture(atlas.irradiance);
        atlas.irradiance = this.pass.irradiance;
    }

    move(motion) {
        if (this.moved === motion.revision) return;
        this.moved = motion.revision;
        this.order.places = motion.moveBlocks(this.points.blocks);
        this.pass.move(motion.chartPoses());
        this.pass.cover.note(motion, this.order.places);
        this.pass.probes.noteMotion();
    }

    // By what the last blocks that were measured took.
    learn(milliseconds) {
        const measured = this.timer.take();
        if (measured) this.cost = measured.milliseconds / measured.about.blocks;
        const fitting = this.cost > 0 ? milliseconds / this.cost : this.perPicture,
            most = milliseconds === Infinity ? Infinity : kMaxGrowth * this.perPicture;
        this.perPicture = Math.max(1, Math.min(fitting, most, this.order.places.length));
    }

    trace(scene, view, { clock, updateMilliseconds }) {
        const isBounded = updateMilliseconds < Infinity,
            count = isBounded ? Math.floor(this.perPicture) : this.order.places.length,
            blocks = this.order.next(count, view);
        if (blocks.length === 0) return;
        this.pass.bounds.forget();
        if (isBounded && !clock) this.timer.begin({ blocks: blocks.length });
        this.pass.begin();
        // First the light along the directions that there are; they follow it from then on.
        for (const directions of [kStored, kGuided])
            this.pass.trace(scene, {
                blocks: blocks.filter(({ rounds }) => (rounds === 0 ? kStored : kGuided) === directions),
                number: ++this.number,
                directions,
            });
        this.timer.end();
        clock?.ended('light');
        this.unfiltered += blocks.length;
        this.milliseconds = blocks.length * (this.cost ?? 0);
    }

    // A step a picture, or all at once: each is of the whole atlas.
    advanceFilter(isWhole) {
        const isDue = this.unfiltered * kFiltersPerPass >= this.order.places.length || this.order.isSettled;
        if (!this.filter && isDue && this.unfiltered > 0) {
            this.filter = this.pass.filter();
            this.unfiltered = 0;
        }
        if (isWhole) Array.from(this.filter ?? []);
        if (this.filter?.next().done) this.filter = null;
    }

    dispose() {
        if (this.pass) this.pass.dispose();
        else this.programs?.dispose();
        this.timer.dispose();
    }
}
