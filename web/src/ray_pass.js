// Lobes that the GPU traces, see src/gl/ray_pass.h for the order of the passes; what punctual lights add at hits is a pass
// of its own here, because three.js's shadow maps are not those of the shaders.
// twin: src/gl/ray_pass.cpp.
import { ShaderProgram } from './gl.js';
import { ProgramSet } from './programs.js';
import { placeNumbers, sampleNumberTables } from './sample_numbers.js';

// Texture units; those of a pixel's lobes come first.
const kPointsUnit = 3,
    kGuidesUnit = 4,
    kTreesUnit = 5,
    kAfterTrees = 9,
    kHitUnits = 3,
    kUnused = 15;
// twin: kRegularized in src/gl/ray_pass.cpp.
const kRegularized = 0.5;
// twin: kSharpAtHits in src/gl/ray_pass.cpp.
const kSharpAtHits = 0.05,
    kSharpUnderSky = 0.15;
// twin: kCountedRays in shaders/reflection_guides.frag.
const kCountedRays = 64;

export class RayPrograms extends ProgramSet {
    // `defines`: of all passes; `hasOpacity`: whether rays pass some surfaces; `hasGlass`: whether any is glass;
    // `hasSky`: whether there is an environment.
    constructor(gl, { defines, scrambles, hasOpacity, hasGlass, hasSky }) {
        const all = hasGlass ? [...defines, 'GLASS'] : defines,
            ofLookup = scrambles ? [...all, 'SCRAMBLES'] : all,
            ofTrees = hasOpacity ? [...all, 'BVH_OPACITY'] : all,
            sky = hasSky ? ['SKY'] : [];
        const fullscreen = (file, more) => new ShaderProgram(gl, 'fullscreen.vert', file, more);
        super({
            lobes: new ShaderProgram(gl, 'surface.vert', 'lobes.frag', [...defines, 'TRACED']),
            guides: fullscreen('reflection_guides.frag', defines),
            trace: fullscreen('trace_reflections.frag', ofTrees),
            shade: fullscreen('shade_reflections.frag', [...ofLookup, ...sky, 'WITHOUT_PUNCTUAL_LIGHTS']),
            hitLights: fullscreen('trace_hit_lights.frag', ofTrees),
            lights: fullscreen('trace_lights.frag', ofTrees),
            ...(hasSky ? { skyLights: fullscreen('trace_lights.frag', [...ofTrees, ...sky]) } : {}),
            mean: fullscreen('mean_reflections.frag', []),
            pool: fullscreen('pool_reflections.frag', []),
            reproject: fullscreen('reproject_reflections.frag', []),
        });
    }
}

// What shaders read of rays' hits, `targets.hits` and `targets.places`, in the first two units, and of the surfaces there,
// in the next ones. Returns the unit after the last.
function bindHits(program, { gl, scene }, targets, spread) {
    program.bind('hits', 0, gl.TEXTURE_2D, targets.hits);
    program.bind('places', 1, gl.TEXTURE_2D, targets.places);
    scene.bindHits(program, 2);
    program.set('brightest', scene.brightest);
    program.set('raySpread', spread);
    return 2 + kHitUnits;
}

// All that shade_reflections.frag reads but the numbers of its samples; `draw` draws with it. twin: bindHitShading in
// src/gl/ray_pass.cpp.
export function shadeHits(program, world, targets, { spread, regularized }, draw) {
    const { gl, scene, passes } = world;
    program.use();
    let unit = passes.bindPhatexels(program, bindHits(program, world, targets, spread));
    program.bind('splitSumTable', unit++, gl.TEXTURE_2D, passes.splitSum);
    program.bind('environment', unit++, gl.TEXTURE_2D, scene.environment.picture);
    gl.bindSampler(unit, scene.linear);
    program.bind('irradiance', unit, gl.TEXTURE_2D_ARRAY, passes.atlas.irradiance);
    program.set('turn', 0);
    if (scene.environment.choices) {
        program.set('skyPoints', scene.environment.points);
        program.set('skyPointRadiance', scene.environment.pointRadiance);
    }
    program.set('regularized', regularized);
    program.set('sharpAtHits', scene.environmentFrom ? kSharpUnderSky : kSharpAtHits);
    draw();
    gl.bindSampler(unit, null);
}

// All that trace_hit_lights.frag reads.
export function bindHitLights(program, world, targets, spread) {
    const { gl, scene, passes } = world;
    program.use();
    bindHits(program, world, targets, spread);
    scene.bindTrees(program, kTreesUnit);
    program.bind('splitSumTable', kAfterTrees, gl.TEXTURE_2D, passes.splitSum);
    program.bind('lightTable', kAfterTrees + 1, gl.TEXTURE_2D, scene.lights);
    program.set('shadowMaps', kUnused);
    program.set('lightCount', scene.lightCount);
    program.set('hasGlass', scene.hasGlass);
    program.set('originUnitMeters', passes.bake.atlas.unitMeters);
}

// A frame for which rays are traced: { gl, noVertices, programs, view, shared, targets, scene, passes, rays, seed }.
// `view`: see Passes.draw; `shared`: the targets of the lookup; `targets`: of the rays; `passes`: with the textures of the
// atlas and the lookup; `rays`: see raysOf.
export class RayPass {
    constructor(frame) {
        Object.assign(this, frame);
        this.programs = frame.programs.all;
        this.numbers = {
            ...sampleNumberTables(this.rays.maxRays, this.seed),
            placeNumbers: placeNumbers(),
        };
        const { passes } = this;
        this.unitMeters = passes.bake.atlas.unitMeters;
    }

    // Before the surfaces are drawn by the program that it returns.
    beginLobes() {
        const { gl, targets, passes } = this,
            { lobes: program } = this.programs;
        gl.bindFramebuffer(gl.FRAMEBUFFER, targets.lobesTarget);
        gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]); // no surface
        program.use();
        program.bind('tilePatches', 0, gl.TEXTURE_2D, passes.atlas.tilePatches);
        program.bind('charts', 1, gl.TEXTURE_2D, passes.atlas.charts);
        program.bind('probes', 2, gl.TEXTURE_2D, passes.probes);
        program.set('unitMeters', this.unitMeters);
        program.set('frame', this.seed);
        return program;
    }

    // Writes to the layers of `shared.incident` that follow the lookup's own.
    trace() {
        const { gl, targets } = this;
        for (const switched of [gl.DEPTH_TEST, gl.CULL_FACE, gl.BLEND]) gl.disable(switched);
        gl.blendEquation(gl.FUNC_ADD);
        gl.blendFunc(gl.ONE, gl.ONE);
        gl.bindVertexArray(this.noVertices);
        targets.incidentTargets.forEach((_, lobe) => this.traceLobe(lobe));
        gl.depthFunc(gl.EQUAL); // as Passes.beginSurfaces has it
    }

    traceLobe(lobe) {
        const { gl, targets, scene } = this;
        this.makeGuides(lobe);
        gl.bindFramebuffer(gl.FRAMEBUFFER, targets.sumsTarget);
        for (const buffer of [0, 1]) gl.clearBufferfv(gl.COLOR, buffer, [0, 0, 0, 0]);
        for (let ray = 0; ray < this.rays.maxRays; ++ray) {
            this.traceRay(lobe, ray);
            gl.enable(gl.BLEND);
            this.shade(ray);
            if (scene.lightCount > 0) this.lightHits(ray);
            gl.disable(gl.BLEND);
        }
        const { lights, skyLights } = this.programs;
        gl.enable(gl.BLEND);
        if (scene.hits.emitterCount > 0) this.traceLights(lights, lobe);
        if (skyLights && scene.environment.choices) this.traceLights(skyLights, lobe);
        gl.disable(gl.BLEND);
        this.pool(lobe);
    }

    // Writes the depths, too, that the shader says.
    drawCounts(target) {
        const { gl } = this;
        gl.enable(gl.DEPTH_TEST);
        gl.depthFunc(gl.ALWAYS);
        gl.depthMask(true);
        this.drawTo(target);
        gl.depthMask(false);
        gl.disable(gl.DEPTH_TEST);
    }

    drawTo(target) {
        const { gl } = this;
        gl.bindFramebuffer(gl.FRAMEBUFFER, target);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    // Over the pixels whose depth is above `depth` alone.
    drawBefore(target, depth) {
        const { gl } = this;
        gl.enable(gl.DEPTH_TEST);
        gl.depthFunc(gl.LESS);
        gl.depthMask(false);
        gl.depthRange(depth, depth);
        this.drawTo(target);
        gl.depthRange(0, 1);
        gl.disable(gl.DEPTH_TEST);
    }

    // Over the pixels that trace more than `ray` rays.
    drawTraced(target, ray) {
        this.drawBefore(target, (ray + 0.5) / kCountedRays);
    }

    // Over the pixels that have the lobe.
    drawLobe(target) {
        this.drawBefore(target, 0.125 / kCountedRays);
    }

    bindLobes(program, lobe) {
        this.passes.bindLobes(program, this.shared, 0);
        program.set('lobe', lobe);
    }

    bindEye(program) {
        const { view } = this;
        program.set('eyeWorld', view.eye);
        program.set('eyeAtInfinity', view.eyeAtInfinity);
        program.set('originUnitMeters', this.unitMeters);
    }

    bindView(program) {
        const { view } = this;
        this.bindEye(program);
        program.set('worldFromClip', view.worldFromClip);
        program.set('viewport', [view.width, view.height]);
    }

    bindPixels(program) {
        const { gl, targets } = this;
        program.bind('points', kPointsUnit, gl.TEXTURE_2D, targets.points);
        program.bind('guides', kGuidesUnit, gl.TEXTURE_2D, targets.guides);
    }

    // What rays meet, in the units after the trees'.
    bindSurfaces(program) {
        const { gl, scene, passes } = this;
        scene.bindHits(program, kAfterTrees);
        program.bind('splitSumTable', kAfterTrees + kHitUnits, gl.TEXTURE_2D, passes.splitSum);
    }

    setNumbers(program, tables = this.numbers) {
        for (const [name, numbers] of Object.entries(tables)) program.set(name, numbers);
    }

    makeGuides(lobe) {
        const { gl, targets } = this,
            { guides: program } = this.programs;
        program.use();
        this.bindLobes(program, lobe);
        program.bind('points', kPointsUnit, gl.TEXTURE_2D, targets.points);
        this.bindView(program);
        program.set('raysPerNeighborhood', this.rays.raysPerNeighborhood);
        program.set('maxRays', this.rays.maxRays);
        this.drawCounts(targets.guidesTarget);
    }

    traceRay(lobe, ray) {
        const { trace: program } = this.programs;
        program.use();
        this.bindLobes(program, lobe);
        this.bindPixels(program);
        this.scene.bindTrees(program, kTreesUnit);
        if (this.scene.hasGlass) this.bindSurfaces(program);
        this.bindEye(program);
        this.setNumbers(program);
        program.set('ray', ray);
        const { gl, targets } = this;
        gl.bindFramebuffer(gl.FRAMEBUFFER, targets.raysTarget);
        gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]); // no ray
        this.drawTraced(targets.raysTarget, ray);
    }

    shade(ray) {
        const { shade: program } = this.programs,
            { targets } = this,
            kind = { spread: this.view.pixelRadians, regularized: kRegularized };
        shadeHits(program, this, targets, kind, () => {
            this.setNumbers(program);
            program.set('ray', ray);
            this.drawTraced(targets.sumsTarget, ray);
        });
    }

    lightHits(ray) {
        const { targets } = this;
        bindHitLights(this.programs.hitLights, this, targets, this.view.pixelRadians);
        this.drawTraced(targets.indirectTarget, ray);
    }

    // Samples of the emitters, or of the sky.
    traceLights(program, lobe) {
        const { gl, targets, scene } = this,
            { lightSamples } = this.rays;
        program.use();
        this.bindLobes(program, lobe);
        this.bindPixels(program);
        scene.bindTrees(program, kTreesUnit);
        this.bindSurfaces(program);
        program.bind('rayWeights', kAfterTrees + kHitUnits + 1, gl.TEXTURE_2D, targets.indirectSums);
        if (program === this.programs.skyLights)
            scene.bindEnvironmentSamples(program, kAfterTrees + kHitUnits + 2);
        this.bindEye(program);
        program.set('brightest', scene.brightest);
        program.set('lightSamples', lightSamples);
        // Others than the rays', whose weights they are multiplied by.
        this.setNumbers(program, { ...this.numbers, ...sampleNumberTables(lightSamples, ~this.seed >>> 0) });
        for (let sample = 0; sample < lightSamples; ++sample) {
            program.set('lightSample', sample);
            this.drawTraced(targets.areaTarget, 0);
        }
    }

    // Means of the pixels' rays, in `hits`, with those of their neighbours.
    pool(lobe) {
        const { gl, targets } = this,
            { mean, pool: program } = this.programs;
        mean.use();
        mean.bind('indirectSums', 0, gl.TEXTURE_2D, targets.indirectSums);
        mean.bind('areaSums', 1, gl.TEXTURE_2D, targets.areaSums);
        mean.set('brightest', this.scene.brightest);
        this.drawLobe(targets.meansTarget);
        program.use();
        program.bind('guides', 1, gl.TEXTURE_2D, targets.guides);
        this.bindView(program);
        for (const isWide of [false, true])
            for (const [from, to, alongWhich] of [
                [targets.hits, targets.pooledTarget, [1, 0]],
                [targets.places, targets.meansTarget, [0, 1]],
            ]) {
                program.bind('lights', 0, gl.TEXTURE_2D, from);
                program.set('alongWhich', alongWhich);
                program.set('isWide', isWide);
                this.drawLobe(to);
            }
        this.write(lobe);
    }

    // For display.frag. Frames before do not count on the page.
    write(lobe) {
        const { gl, shared, targets } = this,
            { reproject: program } = this.programs;
        program.use();
        program.bind('lights', 0, gl.TEXTURE_2D, targets.hits);
        program.bind('guides', 1, gl.TEXTURE_2D, targets.guides);
        program.bind('reflectances', 2, gl.TEXTURE_2D, shared.reflectances);
        program.bind('lastLights', 3, gl.TEXTURE_2D, targets.hits);
        program.bind('lastGuides', 4, gl.TEXTURE_2D, targets.guides);
        this.bindView(program);
        program.set('follows', false);
        program.set('lobe', lobe);
        const target = targets.incidentTargets[lobe];
        gl.bindFramebuffer(gl.FRAMEBUFFER, target);
        for (const layer of [0, 1]) gl.clearBufferuiv(gl.COLOR, layer, [0, 0, 0, 0]);
        this.drawLobe(target);
    }
}
