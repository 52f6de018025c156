// The passes before three.js draws: depth, lobes, lookup, pool, display. Their picture is the light that a bake adds
// to every pixel: all indirect light, and direct light of area lights. One picture is of the opaque
// surfaces; where there are blended ones, another is of the nearest of these. Until the programs of all passes are there,
// a picture may be of fewer: see programs.js.
// twin: src/gl/lookup_pass.cpp, src/gl/display_pass.cpp.
import { createTextureArray } from './gl.js';
import { Programs, kPreview, kWhole } from './programs.js';
import { sampleNumberTables } from './sample_numbers.js';
import { drawSplitSum, prepareUploads, resetState, whiteTexture } from './fixed.js';
import { hasClearcoat, isBlended, isGlass, kOpaqueSlots, kSlots } from './material.js';
import { Rays } from './rays.js';
import { kNeighbor, kReach, partAround, wipedParts } from './parts.js';
import { SurfaceDrawing } from './surface_drawing.js';
import { createVertices } from './vertices.js';
import { createTargets, disposeTargets } from './targets.js';
import { requireRevision } from './three_internals.js';
import { inverseCdfOf, uploadAtlas, uploadGuideTables, uploadProbes, uploadScrambles } from './tables.js';

const kFloatOne = 0x3f800000; // bits
// Views whose pictures are kept: a page's own and a second one, as long as both are drawn.
const kKeptSizes = 2,
    kKeptFrames = 8;
// twin: samplingOf in src/gl/display_pass.cpp
const kSampling = {
    fast: { sampleCount: 2, lightBits: 2 },
    default: { sampleCount: 8, lightBits: 4 },
    high: { sampleCount: 32, lightBits: 4 },
};
// What a lookup costs, over one of 'fast'.
export const kRelativeCost = { fast: 1, default: 3, high: 8 };

export class Passes {
    // `bake`: { surfaces, atlas }, see BakedLight.
    constructor(renderer, bake) {
        requireRevision();
        this.renderer = renderer;
        this.bake = bake;
        this.lookup = null;
        const gl = (this.gl = renderer.getContext());
        gl.getExtension('EXT_color_buffer_float');
        prepareUploads(gl);
        this.vertices = createVertices(gl, bake.surfaces);
        this.noVertices = gl.createVertexArray();
        this.white = whiteTexture(gl);
        this.atlas = uploadAtlas(gl, bake.atlas);
        this.targets = [];
        this.frameCount = 0;
        this.drawing = new SurfaceDrawing(gl, renderer, bake.surfaces, this.white);
        this.rays = new Rays(gl, renderer, this.noVertices);
        this.createPrograms(this.hasAny(hasClearcoat, []));
        this.splitSum = drawSplitSum(gl);
    }

    // What is loaded of it by now, or null. Leaves WebGL's state to the caller, as `draw` does.
    useLookup(lookup) {
        if (this.lookup === lookup) return;
        const { gl } = this,
            { atlas } = this.bake;
        this.lookup = lookup;
        this.freeLookup();
        prepareUploads(gl);
        this.inverseCdfs = uploadGuideTables(gl, gl.RGBA8, lookup.guides, inverseCdfOf);
        this.probes = uploadProbes(gl, lookup.distances, atlas.width / 8, atlas.height / 8);
        this.phatexels = createTextureArray(
            gl,
            gl.RG32UI,
            atlas.width,
            atlas.height,
            lookup.layers.map((layer) => layer.texels),
        );
        this.scrambles =
            lookup.layers.length > 1 ? uploadScrambles(gl, lookup.layers, atlas.blockCount) : null;
        this.programs.setScrambles(Boolean(this.scrambles));
        this.rays.dropPrograms();
    }

    freeLookup() {
        for (const texture of [this.inverseCdfs, this.probes, this.phatexels, this.scrambles])
            this.gl.deleteTexture(texture ?? null);
    }

    createPrograms(clearcoat) {
        const area = Boolean(this.bake.atlas.areaIrradiance);
        this.clearcoat = clearcoat;
        this.layers = (clearcoat ? 2 : 1) * (area ? 2 : 1);
        this.rays.dropPrograms();
        this.programs = new Programs(this.gl, { clearcoat, area });
        this.programs.setScrambles(Boolean(this.scrambles));
    }

    // Pictures of a view's size. Views of two sizes may be drawn in turn; what is not used any more is freed.
    targetsFor({ width, height, copies }) {
        const { gl, layers } = this,
            hasBlended = this.hasAny(isBlended, copies),
            traces = this.rays.level > 0,
            lobeCount = this.clearcoat ? 2 : 1;
        const fits = (t) =>
            [t.width, t.height].join() === [width, height].join() &&
            Boolean(t.blended) === hasBlended &&
            (!traces || Boolean(t.rays));
        const targets =
            this.targets.find(fits) ??
            createTargets(gl, { width, height, layers, lobeCount, hasBlended, traces });
        targets.lastUse = ++this.frameCount;
        const all = [targets, ...this.targets.filter((t) => t !== targets)];
        const isKept = (t, i) => i < kKeptSizes && this.frameCount - t.lastUse < kKeptFrames;
        all.filter((t, i) => !isKept(t, i)).forEach((t) => disposeTargets(gl, t));
        this.targets = all.filter(isKept);
        return targets;
    }

    freeTargets() {
        this.targets.forEach((targets) => disposeTargets(this.gl, targets));
        this.targets = [];
    }

    // Whether that holds for any material.
    hasAny(predicate, copies) {
        return [...this.bake.surfaces.drawRanges, ...copies].some(({ mesh }) => predicate(mesh.material));
    }

    drawDepth(view, target) {
        const { gl } = this;
        gl.bindFramebuffer(gl.FRAMEBUFFER, target.lightTarget);
        gl.depthMask(true);
        gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
        gl.clearBufferfv(gl.DEPTH, 0, [1]);
        gl.enable(gl.DEPTH_TEST);
        gl.depthFunc(gl.LESS);
        gl.colorMask(false, false, false, false);
        const { depth: program } = this.programs;
        program.use();
        this.drawing.draw(program, view, 1);
        gl.colorMask(true, true, true, true);
        gl.depthFunc(gl.EQUAL);
        gl.depthMask(false);
    }

    // State of the passes that draw the surfaces after their depth, wherever others have drawn in between.
    beginSurfaces(view) {
        const { gl } = this;
        resetState(gl, view.width, view.height);
        gl.bindVertexArray(this.vertices.vertexArray);
        gl.enable(gl.DEPTH_TEST);
        gl.depthFunc(gl.EQUAL);
        gl.depthMask(false);
    }

    drawLobes(view, target) {
        const { gl } = this,
            { lobes: program } = this.programs;
        gl.bindFramebuffer(gl.FRAMEBUFFER, target.lobesTarget);
        gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]); // no surface
        program.use();
        this.drawing.draw(program, view, kOpaqueSlots);
    }

    // Glossy light: of PHATexels, and of rays where they are traced.
    lookUp(view, shared, target, light) {
        const lookup = this.programs.stage === kWhole ? this.lookup : null,
            traces = this.tracesIn(view),
            isTimed = lookup && !view.part; // parts cost more than their pixels
        let pass = null;
        if (isTimed) this.rays.beginLookup(kRelativeCost[light.quality]);
        if (traces) pass = this.beginRays(view, shared, light);
        else if (lookup) this.drawLobes(view, target);
        if (pass || lookup) this.clock?.ended('lobes');
        this.drawLookup(view, shared, target, light);
        if (isTimed) this.rays.endLookup();
        if (pass) this.rays.trace(pass);
        if (pass) this.clock?.ended('rays');
        this.gl.bindVertexArray(this.vertices.vertexArray);
        this.gl.enable(this.gl.DEPTH_TEST);
    }

    // Blended surfaces have what the lookup finds.
    tracesIn(view) {
        return this.rays.level > 0 && !view.blended;
    }

    beginRays(view, shared, light) {
        const targets = shared.rays,
            pass = this.rays.passOf(light, { view, shared, targets, passes: this });
        this.beginSurfaces(view);
        this.drawing.draw(pass.beginLobes(), view, kOpaqueSlots);
        return pass;
    }

    drawLookup(view, shared, target, { quality, seed }) {
        const { gl } = this,
            { lookup: program } = this.programs,
            lookup = this.programs.stage === kWhole ? this.lookup : null;
        gl.bindFramebuffer(gl.FRAMEBUFFER, target.incidentTarget);
        // A lobe without samples shows the mean over the hemisphere (display.frag). Of area lights that would be far too
        // much nearly everywhere: until their PHATexels are there, they are black, with a weight of 1.
        const isOfArea = (layer) => this.bake.atlas.areaIrradiance && layer % 2 === 1;
        for (let layer = 0; layer < this.layers; ++layer)
            gl.clearBufferuiv(gl.COLOR, layer, [0, !lookup && isOfArea(layer) ? kFloatOne : 0, 0, 0]);
        if (!lookup) return;
        program.use();
        this.bindLobes(program, shared, this.bindPhatexels(program, 0));
        const { sampleCount, lightBits } = kSampling[quality];
        const { sampleNumbers, ranks } = sampleNumberTables(sampleCount, seed);
        program.set('sampleNumbers', sampleNumbers);
        program.set('ranks', ranks);
        program.set('sampleCount', sampleCount);
        program.set('lightBits', lightBits);
        this.drawing.draw(program, view, 0);
        this.clock?.ended('lookup');
        this.poolSums(shared, target);
        this.clock?.ended('pool');
    }

    // What shaders/lib/lookup_tables.glsl reads, from `unit` on. Returns the unit after the last.
    bindPhatexels(program, unit) {
        const { gl, atlas, lookup } = this;
        program.bind('tilePatches', unit++, gl.TEXTURE_2D, atlas.tilePatches);
        program.bind('phatexels', unit++, gl.TEXTURE_2D_ARRAY, this.phatexels);
        program.bind('inverseCdfs', unit++, gl.TEXTURE_2D, this.inverseCdfs);
        program.bind('probes', unit++, gl.TEXTURE_2D, this.probes);
        program.bind('charts', unit++, gl.TEXTURE_2D, atlas.charts);
        if (this.scrambles) program.bind('scrambles', unit++, gl.TEXTURE_2D, this.scrambles);
        program.set('unitMeters', this.bake.atlas.unitMeters);
        program.set('guideCount', lookup.guideCount);
        program.set('layerCount', lookup.layerCount);
        program.set('areaGuideCount', lookup.areaGuideCount);
        return unit;
    }

    // What shaders/lib/lobe_pixels.glsl reads, from `unit` on.
    bindLobes(program, shared, unit) {
        const { gl } = this;
        program.bind('reflectances', unit, gl.TEXTURE_2D, shared.reflectances);
        program.bind('baseLobes', unit + 1, gl.TEXTURE_2D, shared.baseLobes);
        if (shared.coatLobes) program.bind('coatLobes', unit + 2, gl.TEXTURE_2D, shared.coatLobes);
    }

    poolSums(shared, target) {
        const { gl } = this,
            { pool: program } = this.programs;
        gl.disable(gl.DEPTH_TEST);
        gl.disable(gl.CULL_FACE);
        gl.bindVertexArray(this.noVertices);
        program.use();
        const pool = (from, to, alongWhich) => {
            gl.bindFramebuffer(gl.FRAMEBUFFER, to);
            program.bind('incident', 0, gl.TEXTURE_2D_ARRAY, from);
            program.set('alongWhich', alongWhich);
            gl.drawArrays(gl.TRIANGLES, 0, 3);
        };
        pool(shared.incident, shared.pooledTarget, [1, 0]);
        pool(shared.pooled, target.incidentTarget, [0, 1]);
    }

    // Diffuse light, which all pictures show.
    beginLight(program, target, show) {
        const { gl, atlas } = this;
        gl.bindFramebuffer(gl.FRAMEBUFFER, target.lightTarget);
        program.use();
        program.bind('tileTable', 2, gl.TEXTURE_2D, atlas.tileTable);
        program.bind('irradiance', 3, gl.TEXTURE_2D_ARRAY, atlas.irradiance);
        program.set('show', show);
    }

    preview(view, target, show) {
        const { preview: program } = this.programs;
        this.beginLight(program, target, show);
        this.drawing.draw(program, view, 1);
    }

    display(view, shared, target, show) {
        const { gl, atlas } = this,
            { display: program } = this.programs;
        this.beginLight(program, target, show);
        program.bind('incident', 0, gl.TEXTURE_2D_ARRAY, shared.incident);
        program.bind('tileLight', 1, gl.TEXTURE_2D, atlas.tileLight);
        program.bind('splitSumTable', 4, gl.TEXTURE_2D, this.splitSum);
        program.set('tracedLayer', this.tracesIn(view) ? this.layers : 0);
        this.drawing.draw(program, view, kSlots.length);
    }

    // `view`: { width, height, clipFromWorld, worldFromClip, pixelRadians, eye, eyeAtInfinity, isVisible(mesh), copies, part, occluders };
    // see copies.js; `part`: see parts.js; `light`: a BakedLight. Returns the view's targets. Leaves WebGL's state to the caller.
    draw(view, light) {
        this.clock = light.clock;
        this.clock?.ended('three.js'); // what it did before the first surface
        this.drawing.uploadMaps(view.copies);
        if (!this.clearcoat && this.hasAny(hasClearcoat, view.copies)) {
            this.programs.dispose();
            this.createPrograms(true);
            this.freeTargets();
        }
        light.updates?.follow(this, view);
        this.programs.choose(Boolean(this.lookup), light.waitsForPrograms);
        this.chooseRays(view, light);
        // Rays and what rough glass shows come from all over the picture.
        const part = this.rays.level > 0 || this.hasAny(isGlass, view.copies) ? null : view.part,
            targets = this.targetsFor(view);
        for (const kind of ['opaque', 'blended'])
            if (targets[kind])
                this.drawKind({ ...view, part, blended: kind === 'blended' }, targets, targets[kind], light);
        return targets;
    }

    // Rays hit the room where it was baked, and have one eye: with copies of it, reflections are looked up.
    chooseRays({ width, height, copies }, light) {
        const { defines, stage, scrambles } = this.programs;
        if (stage === kWhole && copies.length === 0) this.rays.choose(light, width * height, { defines, scrambles });
        else Object.assign(this.rays, { level: 0, isAwaited: false });
    }

    // Whether the last picture showed all that is loaded.
    isWhole() {
        return this.programs.isWhole() && !this.rays.isAwaited;
    }

    drawKind(view, shared, target, light) {
        const { gl } = this;
        resetState(gl, view.width, view.height);
        gl.bindVertexArray(this.vertices.vertexArray);
        gl.enable(gl.SCISSOR_TEST);
        gl.scissor(...partAround(view, kNeighbor + kReach));
        this.drawDepth(view, target);
        this.clock?.ended('depth');
        if (this.programs.stage > kPreview) this.lookUp(view, shared, target, light);
        gl.enable(gl.SCISSOR_TEST);
        for (const { scissor, show } of wipedParts(view, kNeighbor, light.wipe)) {
            gl.scissor(...scissor);
            if (this.programs.stage > kPreview) this.display(view, shared, target, show);
            else this.preview(view, target, show);
        }
        gl.disable(gl.SCISSOR_TEST);
        this.clock?.ended('display');
        gl.bindVertexArray(null);
    }

    dispose() {
        const { gl } = this;
        this.freeTargets();
        this.programs.dispose();
        this.rays.dispose();
        this.lightRounds?.dispose();
        this.freeLookup();
        for (const texture of [...Object.values(this.atlas), this.white, this.splitSum])
            gl.deleteTexture(texture);
        this.vertices.buffers.forEach((buffer) => gl.deleteBuffer(buffer));
        gl.deleteVertexArray(this.vertices.vertexArray);
        gl.deleteVertexArray(this.noVertices);
    }
}
