#include "gl/ray_pass.h"

#include <algorithm>

#include "gl/sample_numbers.h"
#include "gl/textures.h"

namespace phat {
namespace {

// twin: kCountedRays in shaders/reflection_guides.frag.
constexpr float kCountedRays = 64;

// Texture units of the passes; shaders with more would exceed the 16 that every GPU has.
constexpr int kPointsUnit = kLobeUnits, kGuidesUnit = kPointsUnit + 1, kBvhUnit = kGuidesUnit + 1,
              kAfterBvh = kBvhUnit + kBvhUnits;

// Of a reflection's alpha: what its hits reflect is so wide at least. See shade_reflections.frag.
constexpr float kRegularized = 0.5f;
// Lobes at hits below this alpha reflect area lights by PHATexels, others by the irradiance and points of the
// emitters, which PHATexels of narrow surfaces are too few for. A sky's part of the irradiance does not come
// from there.
constexpr float kSharpAtHits = 0.05f, kSharpUnderSky = 0.15f;

void bindEye(const ShaderProgram& program, const RayFrame& frame) {
    program.set("eyeWorld", frame.eye.position);
    program.set("eyeAtInfinity", frame.eye.atInfinity ? 1.0f : 0.0f);
    program.set("originUnitMeters", frame.atlas.unitMeters);
}

void bindView(const ShaderProgram& program, const RayFrame& frame) {
    bindEye(program, frame);
    program.set("worldFromClip", glm::inverse(frame.clipFromWorld));
    program.set("viewport", glm::vec2(frame.lookupTargets.size));
}

const RayTargets::Frame& frameOf(const RayTargets& targets, uint32_t number, int lobe) {
    return targets.frames[number % 2][size_t(lobe)];
}

const RayTargets::Frame& nowOf(const RayTargets& targets, const RayFrame& frame, int lobe) {
    return frame.ofPanes ? targets.panes[size_t(lobe)] : frameOf(targets, frame.history.frames, lobe);
}

const GlTexture& guidesOf(const RayTargets& targets, const RayFrame& frame, int lobe) {
    return nowOf(targets, frame, lobe).guides;
}

// Over the pixels that trace more than `ray` rays.
void drawTraced(const FullscreenProgram& program, const GlFramebuffer& target, const RayFrame& frame,
                int ray) {
    program.drawBefore(target, frame.lookupTargets.size, (float(ray) + 0.5f) / kCountedRays);
}

// Over the pixels that have the lobe.
void drawLobe(const FullscreenProgram& program, const GlFramebuffer& target, const RayFrame& frame) {
    program.drawBefore(target, frame.lookupTargets.size, 0.125f / kCountedRays);
}

void makeGuides(const RayPass& pass, const RayTargets& targets, const RayFrame& frame, int lobe) {
    const ShaderProgram& program = pass.guides.program;
    bindLobes(program, frame.lookupTargets, 0);
    program.bind("points", kPointsUnit, targets.points.name());
    bindView(program, frame);
    program.set("lobe", lobe);
    program.set("raysPerNeighborhood", frame.budget.perNeighborhood);
    program.set("maxRays", frame.budget.maxPerPixel);
    pass.guides.drawDepth(nowOf(targets, frame, lobe).guidesTarget, frame.lookupTargets.size);
}

void bindTrace(const RayPass& pass, const RayTargets& targets, const RayFrame& frame, int lobe) {
    const ShaderProgram& program = pass.trace.program;
    bindLobes(program, frame.lookupTargets, 0);
    program.bind("points", kPointsUnit, targets.points.name());
    program.bind("guides", kGuidesUnit, guidesOf(targets, frame, lobe).name());
    bindBvh(frame.scene.bvh, program, kBvhUnit);
    if (pass.glass) {
        bindHits(frame.scene.hits, program, kAfterBvh);
        program.bind("splitSumTable", kAfterBvh + kHitUnits, frame.surfaces.splitSum.name());
    }
    bindEye(program, frame);
    program.set("lobe", lobe);
}

void bindShade(const RayPass& pass, const RayTargets& targets, const RayFrame& frame) {
    const ShaderProgram& program = pass.shade.program;
    bindHitShading(
        program,
        {frame.scene, frame.atlas, frame.lookup, frame.surfaces, frame.shadows, frame.environmentTurn},
        targets.hits, targets.places);
    if (pass.sky) setSkyPoints(frame.surfaces.environment, program, frame.environmentTurn);
    program.set("raySpread", frame.pixelRadians);
    program.set("regularized", kRegularized);
}

// Samples of the emitters, or of the sky.
void traceLights(const FullscreenProgram& lights, const RayTargets& targets, const RayFrame& frame,
                 int lobe) {
    const ShaderProgram& program = lights.program;
    bindLobes(program, frame.lookupTargets, 0);
    program.bind("points", kPointsUnit, targets.points.name());
    program.bind("guides", kGuidesUnit, guidesOf(targets, frame, lobe).name());
    bindBvh(frame.scene.bvh, program, kBvhUnit);
    bindHits(frame.scene.hits, program, kAfterBvh);
    program.bind("splitSumTable", kAfterBvh + kHitUnits, frame.surfaces.splitSum.name());
    program.bind("rayWeights", kAfterBvh + kHitUnits + 1, targets.indirectSums.name());
    bindEnvironmentSamples(frame.surfaces.environment, program, kAfterBvh + kHitUnits + 2);
    program.set("turn", frame.environmentTurn);
    bindEye(program, frame);
    program.set("lobe", lobe);
    program.set("brightest", frame.scene.brightest);
    program.set("lightSamples", frame.budget.lightSamples);
    // Others than the rays', whose weights they are multiplied by.
    setSampleNumbers(program, uint32_t(frame.budget.lightSamples), ~frame.seed);
    for (int sample = 0; sample < frame.budget.lightSamples; ++sample) {
        program.set("lightSample", sample);
        drawTraced(lights, targets.areaTarget, frame, 0);
    }
}

void poolLight(const RayPass& pass, const RayTargets& targets, const RayFrame& frame, int lobe) {
    const ShaderProgram& mean = pass.mean.program;
    mean.bind("indirectSums", 0, targets.indirectSums.name());
    mean.bind("areaSums", 1, targets.areaSums.name());
    mean.set("brightest", frame.scene.brightest);
    drawLobe(pass.mean, targets.meansTarget, frame);
    const auto pool = [&](const GlTexture& from, const GlFramebuffer& to, glm::ivec2 alongWhich, bool wide) {
        const ShaderProgram& program = pass.pool.program;
        program.bind("lights", 0, from.name());
        program.bind("guides", 1, guidesOf(targets, frame, lobe).name());
        bindView(program, frame);
        program.set("alongWhich", alongWhich);
        program.set("isWide", int(wide));
        drawLobe(pass.pool, to, frame);
    };
    for (const bool wide : {false, true}) {
        pool(targets.means, targets.pooledTarget, {1, 0}, wide);
        pool(targets.pooled, targets.meansTarget, {0, 1}, wide);
    }
}

void reproject(const RayPass& pass, const RayTargets& targets, const RayFrame& frame, int lobe) {
    const RayTargets::Frame& now = nowOf(targets, frame, lobe);
    const RayTargets::Frame& last = frameOf(targets, frame.history.frames + 1, lobe);
    const ShaderProgram& program = pass.reproject.program;
    program.bind("lights", 0, targets.means.name());
    program.bind("guides", 1, now.guides.name());
    program.bind("reflectances", 2, frame.lookupTargets.reflectances.name());
    program.bind("lastLights", 3, last.light.name());
    program.bind("lastGuides", 4, last.guides.name());
    bindView(program, frame);
    const RayHistory& history = frame.history;
    program.set("lastClipFromWorld", history.clipFromWorld);
    program.set("lastWorldFromClip", glm::inverse(history.clipFromWorld));
    program.set("lastEye", history.eye.position);
    const bool follows =
        frame.follows && !frame.ofPanes && history.valid && history.eye.atInfinity == frame.eye.atInfinity;
    program.set("follows", int(follows));
    program.set("lobe", lobe);
    glBindFramebuffer(GL_FRAMEBUFFER, now.target.name());
    const GLuint nothing[4] = {0, 0, 0, 0};
    for (GLint layer : {0, 1}) glClearBufferuiv(GL_COLOR, layer, nothing);
    drawLobe(pass.reproject, now.target, frame);
}

void traceLobe(const RayPass& pass, const RayTargets& targets, const RayFrame& frame, int lobe) {
    makeGuides(pass, targets, frame, lobe);
    frame.clock.ended(Pass::rayGuides);
    glBindFramebuffer(GL_FRAMEBUFFER, targets.sumsTarget.name());
    const GLfloat nothing[4] = {0, 0, 0, 0};
    glClearBufferfv(GL_COLOR, 0, nothing);
    glClearBufferfv(GL_COLOR, 1, nothing);
    glBlendFunc(GL_ONE, GL_ONE);
    for (const ShaderProgram* program : {&pass.trace.program, &pass.shade.program})
        setSampleNumbers(*program, uint32_t(frame.budget.maxPerPixel), frame.seed);
    for (int ray = 0; ray < frame.budget.maxPerPixel; ++ray) {
        bindTrace(pass, targets, frame, lobe);
        pass.trace.program.set("ray", ray);
        glBindFramebuffer(GL_FRAMEBUFFER, targets.raysTarget.name());
        const GLuint noRay[4] = {0, 0, 0, 0};
        glClearBufferuiv(GL_COLOR, 0, noRay);
        frame.counter.begin();
        drawTraced(pass.trace, targets.raysTarget, frame, ray);
        frame.counter.end();
        frame.clock.ended(Pass::rayTrace);
        bindShade(pass, targets, frame);
        pass.shade.program.set("ray", ray);
        glEnable(GL_BLEND);
        drawTraced(pass.shade, targets.sumsTarget, frame, ray);
        glDisable(GL_BLEND);
        frame.clock.ended(Pass::rayShade);
    }
    glEnable(GL_BLEND);
    if (frame.scene.hits.emitterCount > 0) traceLights(pass.lights, targets, frame, lobe);
    if (frame.surfaces.environment.choices) traceLights(pass.skyLights, targets, frame, lobe);
    glDisable(GL_BLEND);
    frame.clock.ended(Pass::rayLights);
    poolLight(pass, targets, frame, lobe);
    reproject(pass, targets, frame, lobe);
    frame.clock.ended(Pass::rayPool);
}

}  // namespace

void bindHitShading(const ShaderProgram& program, const LitWorld& world, const GlTexture& hits,
                    const GlTexture& places) {
    program.bind("hits", 0, hits.name());
    program.bind("places", 1, places.name());
    bindHits(world.rays.hits, program, 2);
    int unit = bindPhatexels(program, world.atlas, world.lookup, 2 + kHitUnits);
    program.bind("splitSumTable", unit++, world.surfaces.splitSum.name());
    program.bind("lightTable", unit++, world.shadows.lightTable.name());
    program.bind("shadowMaps", unit++, world.shadows.depth.name());
    program.bind("irradiance", unit++, world.atlas.irradiance.name(), world.rays.hits.filtered.name());
    const GpuEnvironment& sky = world.surfaces.environment;
    bindEnvironment(sky, program, unit++);
    program.set("lightCount", world.shadows.lightCount);
    program.set("turn", world.environmentTurn);
    program.set("sharpAtHits", sky.picture ? kSharpUnderSky : kSharpAtHits);
    program.set("brightest", world.rays.brightest);
}

RayPass createRayPass(const std::string& folder, const LookupPass& lookup, const GpuLookup& tables,
                      const RayFeatures& features) {
    RayPass pass;
    pass.clearcoat = lookup.clearcoat;
    pass.glass = features.glass;
    pass.sky = features.sky;
    std::vector<std::string> defines = phatexelDefines(tables);
    if (lookup.clearcoat) defines.push_back("CLEARCOAT");
    if (features.glass) defines.push_back("GLASS");
    if (features.counts) defines.push_back("COUNT_FETCHES");
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.end(), defines.begin(), defines.end());
        return more;
    };
    pass.lobes = ShaderProgram(folder, "surface.vert", "lobes.frag", with({"TRACED", "COUNT_ONLY_READS"}));
    pass.guides = FullscreenProgram(folder, "reflection_guides.frag", with({"WRITES_DEPTH"}));
    pass.trace = FullscreenProgram(folder, "trace_reflections.frag", with(features.bvhDefines));
    pass.lights = FullscreenProgram(folder, "trace_lights.frag", with(features.bvhDefines));
    if (features.sky) defines.push_back("SKY");
    pass.shade = FullscreenProgram(folder, "shade_reflections.frag", defines);
    if (features.sky)
        pass.skyLights = FullscreenProgram(folder, "trace_lights.frag", with(features.bvhDefines));
    pass.mean = FullscreenProgram(folder, "mean_reflections.frag", defines);
    pass.pool = FullscreenProgram(folder, "pool_reflections.frag", defines);
    pass.reproject = FullscreenProgram(folder, "reproject_reflections.frag", defines);
    return pass;
}

bool isReady(const RayPass& pass) {
    const auto ready = [](const FullscreenProgram& program) { return program.program.isReady(); };
    return pass.lobes.isReady() && ready(pass.guides) && ready(pass.trace) && ready(pass.shade) &&
           ready(pass.lights) && (!pass.sky || ready(pass.skyLights)) && ready(pass.mean) &&
           ready(pass.pool) && ready(pass.reproject);
}

namespace {

RayTargets::Frame createRayFrame(const LookupTargets& lookup, const GlTexture& counts, const GlTexture& light,
                                 int layer) {
    RayTargets::Frame frame;
    frame.guides = createTexture2D(GL_RGBA32UI, lookup.size);
    frame.light = createTexture2D(GL_RGBA32UI, lookup.size);
    frame.guidesTarget = createFramebuffer({{frame.guides.name()}}, counts.name());
    frame.target = createFramebuffer(
        {{light.name(), 0, layer}, {light.name(), 0, layer + 1}, {frame.light.name()}}, counts.name());
    return frame;
}

GlFramebuffer createLobesTarget(const RayTargets& targets, const LookupTargets& lookup, GLuint depth) {
    std::vector<Attachment> lobes = {{lookup.reflectances.name()}, {lookup.baseLobes.name()}};
    if (lookup.coatLobes) lobes.push_back({lookup.coatLobes.name()});
    lobes.push_back({targets.points.name()});
    return createFramebuffer(lobes, depth);
}

}  // namespace

RayTargets createRayTargets(const LookupPass& pass, const LookupTargets& lookup, GLuint depth) {
    RayTargets t;
    const glm::uvec2 size = lookup.size;
    for (GlTexture* words : {&t.points, &t.hits, &t.places, &t.means, &t.pooled})
        *words = createTexture2D(GL_RGBA32UI, size);
    t.indirectSums = createTexture2D(GL_RGBA16F, size);
    t.areaSums = createTexture2D(GL_RGBA16F, size);
    t.lobesTarget = createLobesTarget(t, lookup, depth);
    t.counts = createTexture2D(GL_DEPTH_COMPONENT16, size);
    const GLuint counts = t.counts.name();
    t.raysTarget = createFramebuffer({{t.hits.name()}, {t.places.name()}}, counts);
    t.sumsTarget = createFramebuffer({{t.indirectSums.name()}, {t.areaSums.name()}}, counts);
    t.areaTarget = createFramebuffer({{t.areaSums.name()}}, counts);
    t.meansTarget = createFramebuffer({{t.means.name()}}, counts);
    t.pooledTarget = createFramebuffer({{t.pooled.name()}}, counts);
    for (int i = 0; i < 2 * (pass.clearcoat ? 2 : 1); ++i) {
        const int lobe = i / 2, layer = lookedUpLayers(pass) + 2 * lobe;
        t.frames[size_t(i % 2)].push_back(createRayFrame(lookup, t.counts, lookup.incident, layer));
    }
    checkGl("creating the rays' targets");
    return t;
}

void addPaneTargets(RayTargets& targets, const LookupTargets& lookup, GLuint depth, const GlTexture& light) {
    if (targets.paneLobesTarget) return;
    targets.paneLobesTarget = createLobesTarget(targets, lookup, depth);
    for (size_t lobe = 0; lobe < targets.frames[0].size(); ++lobe)
        targets.panes.push_back(createRayFrame(lookup, targets.counts, light, 2 * int(lobe)));
    checkGl("creating the targets of rays from glass");
}

void beginTracedLobes(const RayPass& pass, const RayTargets& targets, const RayFrame& frame) {
    if (!frame.ofPanes) clearSums(frame.lookupTargets);
    const GlFramebuffer& target = frame.ofPanes ? targets.paneLobesTarget : targets.lobesTarget;
    glBindFramebuffer(GL_FRAMEBUFFER, target.name());
    const GLuint noSurface[4] = {0, 0, 0, 0};
    glClearBufferuiv(GL_COLOR, 0, noSurface);
    pass.lobes.bind("tilePatches", 0, frame.atlas.tilePatches.name());
    pass.lobes.bind("charts", 1, frame.atlas.charts.name());
    pass.lobes.bind("probes", 2, frame.lookup.probes.name());
    pass.lobes.set("unitMeters", frame.atlas.unitMeters);
    pass.lobes.set("frame", int(frame.seed));
}

void traceLobes(const RayPass& pass, const RayTargets& targets, const RayFrame& frame) {
    for (int lobe = 0; lobe < (pass.clearcoat ? 2 : 1); ++lobe) traceLobe(pass, targets, frame, lobe);
    if (frame.ofPanes) return;
    frame.history = {frame.clipFromWorld, frame.eye, frame.history.frames + 1, true};
}

}  // namespace phat
