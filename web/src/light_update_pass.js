// PHATexels and irradiance of blocks of the atlas made anew, one ray each.
// twin: src/gl/light_update_pass.cpp; what punctual lights add at hits is a pass of its own, as in ray_pass.js.
import later from 'phat:later-shaders';
import { ShaderProgram, addShaders, createFramebuffer, createTexture2D, createTextureArray } from './gl.js';
import { prepareUploads, resetState } from './fixed.js';
import { GuidePass } from './guide_pass.js';
import { bakedEstimates, kLights, kRays, layoutOf } from './light_tables.js';
import { ProbePass } from './probe_pass.js';
import { ProgramSet } from './programs.js';
import { hashOf } from './sample_numbers.js';
import { createTable } from './tables.js';
import { TexelBatch, batchTarget, kBatchBlocks } from './texel_batch.js';
import { TexelCover } from './texel_cover.js';
import { kBlockSize, shownNormals } from './texel_points.js';
import { TileBounds } from './tile_bounds.js';

// Steps of 1, 2, 4, 8 and 16 texels.
const kFilterPasses = 5;
// twin: the constants of trace_texels.frag.
export const kStored = 0, // the directions that PHATexels have
    kGuided = 1; // others, by guides that follow the light
const kDiffuse = 2;
// Texture units; trees come first.
const kTreeUnits = 4,
    kTexelPointUnits = 4,
    kHitUnits = 3;

export class LightPrograms extends ProgramSet {
    // As of RayPrograms.
    constructor(gl, { defines, scrambles, hasOpacity }) {
        addShaders(later);
        const ofLookup = scrambles ? [...defines, 'SCRAMBLES'] : defines,
            ofTrees = hasOpacity ? [...defines, 'BVH_OPACITY'] : defines;
        const fullscreen = (file, more = []) => new ShaderProgram(gl, 'fullscreen.vert', file, more);
        super({
            gather: fullscreen('gather_guides.frag'),
            tabulate: fullscreen('tabulate_guides.frag'),
            cover: fullscreen('cover_texels.frag', ofTrees),
            traceProbes: fullscreen('trace_probes.frag', ofTrees),
            packProbes: fullscreen('pack_probes.frag'),
            packRanges: fullscreen('pack_probes.frag', ['RANGE']),
            trace: fullscreen('trace_texels.frag', ofTrees),
            shade: fullscreen('shade_reflections.frag', [...ofLookup, 'WITHOUT_PUNCTUAL_LIGHTS', 'TEXELS']),
            hitLights: fullscreen('trace_hit_lights.frag', ofTrees),
            lights: fullscreen('light_texels.frag', ofTrees),
            pack: fullscreen('pack_phatexels.frag'),
            estimate: fullscreen('estimate_irradiance.frag'),
            brightest: fullscreen('bound_tiles.frag', ['FIRST']),
            bounds: fullscreen('bound_tiles.frag'),
            filterFirst: fullscreen('filter_irradiance.frag', ['FIRST']),
            filter: fullscreen('filter_irradiance.frag'),
        });
    }
}

export class LightUpdatePass {
    // `passes`: whose textures are written to from now on; `points`: TexelPoints; `programs`: compiled LightPrograms.
    // Leaves WebGL's state to the caller.
    constructor(passes, points, programs) {
        const { gl } = passes,
            { lookup } = passes,
            { atlas } = passes.bake;
        Object.assign(this, { gl, passes, blocks: points.blocks, set: programs, programs: programs.all });
        this.sources = [
            { isArea: false, firstLayer: 0, layers: lookup.layerCount, firstGuide: 0, guideCount: lookup.guideCount },
            {
                isArea: true,
                firstLayer: lookup.layerCount,
                layers: lookup.layers.length - lookup.layerCount,
                firstGuide: lookup.guideCount,
                guideCount: lookup.areaGuideCount,
            },
        ].slice(0, atlas.areaIrradiance ? 2 : 1);
        prepareUploads(gl);
        this.guides = new GuidePass(passes, this.programs);
        this.createLight(atlas, points);
        this.createTargets(atlas);
        this.cover = new TexelCover(this, points);
        this.probes = new ProbePass(this);
        this.bounds = new TileBounds(this);
    }

    // What is known of the light beside what pictures are drawn from.
    createLight({ width, height, charts, indirectIrradiance, areaIrradiance }, points) {
        const { gl } = this,
            identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
        this.move(Float32Array.from(charts.flatMap(() => identity)));
        this.points = createTexture2D(gl, gl.RGBA32UI, width, height, points.places);
        this.normals = createTexture2D(gl, gl.R32UI, width, height, shownNormals(points));
        const none = new Uint32Array(4 * width * height);
        this.estimates = createTextureArray(gl, gl.RGBA32UI, width, height, [
            bakedEstimates(indirectIrradiance, points, false),
            areaIrradiance ? bakedEstimates(areaIrradiance, points, true) : none,
        ]);
    }

    // Texels to where they are now: Motion.chartPoses. Leaves WebGL's state to the caller.
    move(poses) {
        const { gl } = this;
        gl.deleteTexture(this.poses ?? null);
        prepareUploads(gl);
        this.poses = createTable(gl, gl.RGBA32F, poses);
    }

    createTargets({ width, height }) {
        const { gl } = this,
            side = batchTarget(kBlockSize),
            texture = (format) => createTexture2D(gl, format, side, side);
        [this.hits, this.places, this.indirectEstimate, this.areaEstimate] = Array.from({ length: 4 }, () =>
            texture(gl.RGBA32UI),
        );
        this.codes = texture(gl.R32UI);
        this.packed = texture(gl.RG32UI);
        [this.indirect, this.area] = [0, 1].map(() => texture(gl.RGBA16F));
        this.filtered = [0, 1].map(() => createTexture2D(gl, gl.RGBA16F, width, height));
        this.irradiance = createTextureArray(gl, gl.RGBA16F, width, height, this.sources.length);
        this.targets = {
            rays: createFramebuffer(gl, [this.hits, this.places, this.codes]),
            light: createFramebuffer(gl, [this.indirect, this.area]),
            indirect: createFramebuffer(gl, [this.indirect]),
            area: createFramebuffer(gl, [this.area]),
            packed: createFramebuffer(gl, [this.packed]),
            codes: createFramebuffer(gl, [this.codes]),
            estimates: createFramebuffer(gl, [this.indirectEstimate, this.areaEstimate]),
            filtered: this.filtered.map((of) => createFramebuffer(gl, [of])),
            irradiance: this.sources.map((_, layer) =>
                createFramebuffer(gl, [{ texture: this.irradiance, layer }]),
            ),
        };
    }

    // The irradiance of `blocks` (BlockOrder.next) is estimated better, and shown once it is filtered. `scene`: a RayScene;
    // `number`: of the round; `directions`: of the PHATexels, which are replaced, kStored or kGuided.
    trace(scene, { blocks, number, directions }) {
        const { gl, passes } = this;
        this.world = { gl, scene, passes };
        for (let first = 0; first < blocks.length; first += kBatchBlocks) {
            this.batch = new TexelBatch(gl, this.blocks, blocks.slice(first, first + kBatchBlocks));
            this.cover.update(scene, this.batch);
            this.probes.update(scene, this.batch);
            this.seed = hashOf(number, first);
            this.sources.forEach((source) => this.tracePhatexels(source, directions));
            this.estimateIrradiance();
        }
    }

    draw(target, [width, height] = this.batch.size) {
        const { gl } = this;
        gl.bindFramebuffer(gl.FRAMEBUFFER, target);
        gl.viewport(0, 0, width, height);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    begin() {
        resetState(this.gl, 1, 1);
        this.gl.bindVertexArray(this.passes.noVertices);
        this.gl.blendEquation(this.gl.FUNC_ADD);
        this.gl.blendFunc(this.gl.ONE, this.gl.ONE);
    }

    drawAdded(target) {
        this.gl.enable(this.gl.BLEND);
        this.draw(target);
        this.gl.disable(this.gl.BLEND);
    }

    // What lib/texel_point.glsl reads, from `unit` on.
    bindTexelPoints(program, unit) {
        const { gl } = this;
        program.bind('texelPoints', unit, gl.TEXTURE_2D, this.points);
        program.bind('texelNormals', unit + 1, gl.TEXTURE_2D, this.normals);
        program.bind('chartPoses', unit + 2, gl.TEXTURE_2D, this.poses);
        program.bind('tileTable', unit + 3, gl.TEXTURE_2D, this.passes.atlas.tileTable);
    }

    traceRays(choice, layer, { firstGuide, guideCount }, scrambleOf) {
        const { gl, passes } = this,
            { trace: program } = this.programs,
            { unitMeters } = passes.bake.atlas;
        program.use();
        this.world.scene.bindTrees(program, 0);
        this.bindTexelPoints(program, kTreeUnits);
        let unit = kTreeUnits + kTexelPointUnits;
        program.bind('guideSums', unit++, gl.TEXTURE_2D, this.guides.sums);
        program.bind('phatexels', unit++, gl.TEXTURE_2D_ARRAY, passes.phatexels);
        program.bind('tilePatches', unit, gl.TEXTURE_2D, passes.atlas.tilePatches);
        for (const [name, value] of Object.entries({ unitMeters, originUnitMeters: unitMeters, choice, layer }))
            program.set(name, value);
        program.set('firstGuide', firstGuide);
        program.set('guideCount', guideCount);
        program.set('seed', this.seed | 0);
        this.batch.set(program, scrambleOf);
        this.draw(this.targets.rays);
    }

    shade() {
        const { shade: program, hitLights } = this.programs,
            { light } = this.targets,
            { tracing } = this.world.scene;
        tracing.shadeHits(program, this.world, this, { spread: 0, regularized: 0 }, () => this.draw(light));
        if (this.world.scene.lightCount === 0) return;
        tracing.bindHitLights(hitLights, this.world, this, 0);
        this.drawAdded(this.targets.indirect);
    }

    // Directions are drawn by guides that follow from the PHATexels before, but what looks up PHATexels sees both change at
    // once.
    tracePhatexels(source, directions) {
        const { gl, passes, batch } = this,
            { pack: program } = this.programs,
            { isArea, firstLayer } = source,
            follows = directions === kGuided && source.guideCount > 1; // one guide for all blocks stays
        if (follows) this.guides.follow(batch, source, (target, size) => this.draw(target, size));
        for (let layer = firstLayer; layer < firstLayer + source.layers; ++layer) {
            const { scrambles } = passes.lookup.layers[layer];
            this.traceRays(directions, layer, source, ({ block }) => scrambles[block]);
            this.shade();
            program.use();
            program.bind('hits', 0, gl.TEXTURE_2D, this.hits);
            program.bind('codes', 1, gl.TEXTURE_2D, this.codes);
            program.bind('radiance', 2, gl.TEXTURE_2D, isArea ? this.area : this.indirect);
            program.set('unitMeters', passes.bake.atlas.unitMeters);
            this.draw(this.targets.packed);
            batch.copyTexels(this.targets.packed, 0, passes.phatexels, layer);
            // At hits, the first layer alone is looked up.
            if (follows && layer === firstLayer) this.guides.show(batch, source);
        }
    }

    // Light of a sampled point of an emitter.
    traceLights() {
        const { gl, passes } = this,
            { scene } = this.world,
            { lights: program } = this.programs;
        program.use();
        scene.bindTrees(program, 0);
        this.bindTexelPoints(program, kTreeUnits);
        scene.bindHits(program, kTreeUnits + kTexelPointUnits);
        const unit = kTreeUnits + kTexelPointUnits + kHitUnits;
        program.bind('splitSumTable', unit, gl.TEXTURE_2D, passes.splitSum);
        program.set('originUnitMeters', passes.bake.atlas.unitMeters);
        program.set('seed', ~this.seed);
        this.batch.set(program, (turn) => layoutOf(kLights, turn));
        this.drawAdded(this.targets.area);
    }

    estimateIrradiance() {
        const { gl, passes, targets } = this,
            { estimate: program } = this.programs;
        this.traceRays(kDiffuse, 0, this.sources[0], (turn) => layoutOf(kRays, turn));
        this.shade();
        if (this.world.scene.hits.emitterCount > 0) this.traceLights();
        program.use();
        program.bind('indirectLight', 0, gl.TEXTURE_2D, this.indirect);
        program.bind('areaLight', 1, gl.TEXTURE_2D, this.area);
        program.bind('estimates', 2, gl.TEXTURE_2D_ARRAY, this.estimates);
        program.bind('splitSumTable', 3, gl.TEXTURE_2D, passes.splitSum);
        program.bind('hits', 4, gl.TEXTURE_2D, this.hits);
        this.bindTexelPoints(program, 5);
        this.batch.set(program, () => 0);
        this.draw(targets.estimates);
        for (const source of [0, 1]) this.batch.copyTexels(targets.estimates, source, this.estimates, source);
    }

    // Filters the irradiance of all texels, from the estimates so far; a step of the filter for each value that is asked
    // for. It is shown from the last one on.
    *filter() {
        const { gl, passes, targets } = this,
            { width, height } = passes.bake.atlas;
        for (const source of this.sources.keys())
            for (let i = 0; i < kFilterPasses; ++i) {
                const program = i === 0 ? this.programs.filterFirst : this.programs.filter;
                this.begin();
                program.use();
                this.bindTexelPoints(program, 0);
                if (i === 0) program.bind('estimates', kTexelPointUnits, gl.TEXTURE_2D_ARRAY, this.estimates);
                else program.bind('before', kTexelPointUnits, gl.TEXTURE_2D, this.filtered[(i + 1) % 2]);
                program.set('source', source);
                program.set('step', 1 << i);
                const isLast = i === kFilterPasses - 1;
                this.draw(isLast ? targets.irradiance[source] : targets.filtered[i % 2], [width, height]);
                yield;
            }
    }

    dispose() {
        const { gl } = this,
            of = ({ filtered, irradiance, ...others }) => [...Object.values(others), ...filtered, ...irradiance];
        of(this.targets).forEach((framebuffer) => gl.deleteFramebuffer(framebuffer));
        // `irradiance` is the passes' own.
        const { points, normals, poses, estimates, hits, places, indirectEstimate, areaEstimate } = this;
        for (const texture of [points, normals, poses, estimates, hits, places, indirectEstimate, areaEstimate])
            gl.deleteTexture(texture);
        for (const texture of [this.codes, this.packed, this.indirect, this.area, ...this.filtered])
            gl.deleteTexture(texture);
        this.guides.dispose();
        this.cover.dispose();
        this.probes.dispose();
        this.bounds.dispose();
        this.set.dispose();
    }
}
