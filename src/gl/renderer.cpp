#include "gl/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "core/base/stopwatch.h"
#include "core/phatexel/lookup_tables.h"
#include "gl/gl_error.h"
#include "gl/renderer_state.h"
#include "gl/resident_bytes.h"
#include "gl/textures.h"

namespace phat {
namespace {

// Whether shadow maps of two versions of a material are the same: depth.frag reads no more of it
// but where it is glass.
bool castSameShadow(const Material& a, const Material& b) {
    if (isGlass(a) || isGlass(b)) return a == b;
    return a.alphaMode == b.alphaMode && a.alphaCutoff == b.alphaCutoff && a.baseColor.a == b.baseColor.a;
}

void requireOpenGl45() {
    if (epoxy_gl_version() < 45 || !epoxy_is_desktop_gl())
        throw GlError(fmt::format("OpenGL 4.5 is needed, this driver offers {}",
                                  reinterpret_cast<const char*>(glGetString(GL_VERSION))));
}

double bytesOfPhatexel(const Phatexture& phatexture) {
    const double tiles = double(phatexture.tilePatches.size()), layers = double(phatexture.indirect.size());
    const double texels = tiles * kTileSize * kTileSize;
    const double beside = double(phatexture.indirectGuides.size() * sizeof(InverseCdf)) +
                          tiles * (sizeof(PackedTile) + kProbeSize * kProbeSize / 2);
    return sizeof(PackedPhatexel) + beside / (texels * layers);
}

}  // namespace

Renderer::Renderer(const RendererInput& input, const std::string& shaderFolder) {
    requireOpenGl45();
    state_ = std::make_unique<State>();
    state_->shaderFolder = shaderFolder;
    state_->show(input.scene, input.atlas, input.points);
    state_->materials = input.scene.materials;
    state_->findGlass();
    state_->lights = input.scene.lights;
    state_->scene = uploadScene(input.scene, input.atlas);
    if (input.added) state_->added.emplace(uploadAdded(*input.added));
    state_->atlas = uploadAtlas(input.scene, input.atlas, input.phatexture);
    state_->lookup = uploadLookup(input.phatexture, input.atlas);
    if (state_->lookup.guideCount > 0) state_->bytesPerPhatexel = bytesOfPhatexel(input.phatexture);
    if (input.scene.environment) state_->environmentWidth = input.scene.environment->radiance.width;
    state_->restBvh = input.bvh;
    state_->commonPass();  // reports at the start that shaders are missing
}

Renderer::~Renderer() = default;

void Renderer::draw(const FrameSettings& settings, PictureSum& sum) {
    restartTimes();
    for (int left = samplesToDraw(settings, sum); left > 0; --left) {
        finishSample(beginSample(settings, Reflections::lookup, sum), {}, sum);
        if (sum.preview) break;
    }
}

PendingSample Renderer::beginSample(const FrameSettings& settings, Reflections reflections, PictureSum& sum) {
    State& s = *state_;
    PendingSample sample{s.possible(settings), reflections, {}, {}, {}, {}, false};
    if (sample.settings.method != Method::phat || sample.settings.tracedByGpu != Reflections::lookup)
        sample.reflections = Reflections::lookup;
    const bool traced = sample.reflections != Reflections::lookup;
    sample.preview = s.previews(sample.settings, traced);
    const int count = std::max(1, settings.samplesPerPixel);
    if (sum.size != sizeOf(settings)) sum = createPictureSum(sizeOf(settings));
    if (sum.samples >= count || sum.preview) sum.samples = 0;
    sum.preview = false;
    if (settings.filter == PixelFilter::box) sample.jitter = jitterOf(sum.samples, count);
    const glm::vec3 parts = shownParts(settings.component);
    sample.view = {settings.camera,          int(sum.size.x), int(sum.size.y), uint32_t(sum.samples),
                   settings.samplesPerPixel, parts.y > 0,     parts.x > 0,     settings.filter};
    const State::Prepared prepared = s.prepare(sample.settings, traced, sample.preview);
    prepareSample(prepared.common, prepared.input, s.targets, sample);
    checkGl("drawing a frame");
    return sample;
}

void Renderer::finishSample(const PendingSample& sample, const TracedIncident& incident, PictureSum& sum) {
    assert(incident.surfaces.size() == sample.surfaces.size());
    assert(incident.panes.size() == sample.panes.size());
    assert(sum.samples == int(sample.view.frame));
    State& s = *state_;
    const State::Prepared prepared =
        s.prepare(sample.settings, sample.reflections != Reflections::lookup, sample.preview);
    displaySample(prepared.common, prepared.input, s.targets, sample, incident);
    addSample(prepared.common, s.targets, sum);
    sum.preview = sample.preview;
    checkGl("drawing a frame");
}

void Renderer::restartTimes() {
    state_->clockRestarts = true;
}

Image Renderer::render(const FrameSettings& settings) {
    PictureSum sum;
    draw(settings, sum);
    return readMean(sum);
}

FrameTimes Renderer::lastFrameTimes() const {
    const PassClock& clock = state_->clock;
    FrameTimes times;
    times.relight = clock.seconds(Pass::relight);
    times.pyramid = clock.seconds(Pass::pyramid);
    times.shadows = clock.seconds(Pass::shadows);
    times.depth = clock.seconds(Pass::depth);
    times.lobes = clock.seconds(Pass::lobes);
    times.lookup = clock.seconds(Pass::lookup);
    times.pool = clock.seconds(Pass::pool);
    times.rayGuides = clock.seconds(Pass::rayGuides);
    times.rayTrace = clock.seconds(Pass::rayTrace);
    times.rayShade = clock.seconds(Pass::rayShade);
    times.rayLights = clock.seconds(Pass::rayLights);
    times.rayPool = clock.seconds(Pass::rayPool);
    times.display = clock.seconds(Pass::display);
    return times;
}

uint64_t Renderer::lastFrameRays() const {
    return state_->rayCounter.rays();
}

uint64_t Renderer::countRayFetches(FrameSettings settings) {
    settings.samplesPerPixel = 1;
    GLuint name = 0;
    glCreateBuffers(1, &name);
    const GlBuffer buffer(name);
    GLuint count = 0;
    glNamedBufferStorage(name, sizeof(count), &count, 0);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, name);
    state_->countsFetches = true;
    render(settings);
    state_->countsFetches = false;
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(name, 0, sizeof(count), &count);
    checkGl("counting what rays read");
    return count;
}

double Renderer::bytesPerPhatexel() const {
    return state_->bytesPerPhatexel;
}

ResidentBytes Renderer::residentBytes() const {
    const State& s = *state_;
    ResidentBytes bytes = residentBytesOf(s.scene, s.atlas, s.lookup, s.shadows, s.targets);
    if (s.added) bytes.scene += addedBytes(*s.added);
    if (s.rayScene) bytes.rays = rayBytes(*s.rayScene);
    for (const auto* relit : {&s.relit, &s.relitPaper})
        if (*relit) bytes.pyramid += pyramidBytes((*relit)->pass);
    if (s.surfaces) bytes.pyramid += surfaceBytes(*s.surfaces);
    return bytes;
}

void Renderer::setMaterials(const std::vector<Material>& materials) {
    State& s = *state_;
    if (materials.size() != s.materials.size())
        throw GlError("materials may be changed, not added or removed");
    const bool coatAppears = anyClearcoat(materials) && !anyClearcoat(s.materials);
    if (!std::equal(materials.begin(), materials.end(), s.materials.begin(), castSameShadow)) s.shadows = {};
    s.materials = materials;
    s.raysEdited = true;
    s.findGlass();
    s.texelsChanged();
    if (coatAppears) s.dropPasses();
}

void Renderer::setLights(const std::vector<PunctualLight>& lights) {
    if (lights == state_->lights) return;
    if (hasDisc(lights) != hasDisc(state_->lights)) state_->dropPasses();
    state_->lights = lights;
    state_->shadows = {};
    state_->rayHistory.valid = false;
}

void Renderer::moveScene(const Scene& scene, const Atlas& atlas, const TexelPoints& points,
                         std::span<const glm::mat4> worldFromRest) {
    State& s = *state_;
    s.worldFromRest.assign(worldFromRest.begin(), worldFromRest.end());
    s.raysMoved = s.raysEdited = true;
    phat::moveScene(s.scene, scene, atlas);
    s.show(scene, atlas, points);
    if (s.light) {
        moveTexelPoints(s.light->points, scene, atlas, worldFromRest);
        noteMotion(s.light->moved, scene, worldFromRest);
    }
    s.surfacesTurned = true;
    s.lights = scene.lights;
    s.shadows = {};
    s.texelsChanged();
}

bool Renderer::takeUpdate(LightUpdate& update, double seconds) {
    State& s = *state_;
    const Stopwatch start;
    const auto late = [&] { return start.seconds() > seconds; };
    if (!update.empty()) s.texelsChanged();
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    const glm::uvec2 tiles = s.atlas.sizeTexels / kTileSize;
    for (const LightUpdate::TileGeometry& tile : update.tileGeometries) {
        updateTilePatch(s.atlas, tile);
        if (s.lookup.guideCount > 0) updateProbe(s.lookup, tile, tiles);
        // The baker's thread moves tiles, but traces no probes where the GPU makes the light.
        const glm::uvec2 place(tile.tile % tiles.x, tile.tile / tiles.x);
        if (s.light) s.light->moved.staleProbes[s.shownAtlas->blockAt(kTileSize * place)] = 1;
    }
    update.tileGeometries.clear();
    if (!update.tileLight.empty()) updateTileLight(s.atlas, update.tileLight);
    update.tileLight.clear();
    update.occlusions.clear();

    // One portion at least, so that all is done in the end, however little time there is.
    size_t tile = 0, block = 0;
    while (tile < update.phatexels.size() && (tile == 0 || !late())) {
        const uint32_t now = update.phatexels[tile].block;
        if (block < update.guides.size() && update.guides[block].block == now) {
            updateGuides(s.atlas, update.guides[block]);
            updateLookupGuides(s.lookup, update.guides[block]);
            ++block;
        }
        for (; tile < update.phatexels.size() && update.phatexels[tile].block == now; ++tile)
            updatePhatexels(s.atlas, update.phatexels[tile]);
    }
    update.phatexels.erase(update.phatexels.begin(), update.phatexels.begin() + ptrdiff_t(tile));
    update.guides.erase(update.guides.begin(), update.guides.begin() + ptrdiff_t(block));
    size_t done = 0;
    for (; done < update.irradiance.size() && ((tile == 0 && done < 64) || done % 64 != 0 || !late()); ++done)
        updateIrradiance(s.atlas, update.irradiance[done]);
    update.irradiance.erase(update.irradiance.begin(), update.irradiance.begin() + ptrdiff_t(done));
    checkGl("taking over updated PHATexels");
    return update.empty();
}

void Renderer::beginLight(const RendererInput& rest) {
    State& s = *state_;
    if (!s.restBvh || s.lookup.guideCount == 0) throw GlError("this bake's light cannot be made by the GPU");
    s.light = createGpuLight(rest.scene, rest.atlas, rest.points, rest.phatexture);
    moveTexelPoints(s.light->points, rest.scene, rest.atlas, s.worldFromRest);
    noteMotion(s.light->moved, *s.shownScene, s.worldFromRest);
    s.lightPass = createLightUpdatePass(s.shaderFolder, s.atlas, s.lookup, bvhDefines(*s.restBvh));
}

std::vector<float> Renderer::traceLight(const LightRound& round) {
    State& s = *state_;
    assert(s.light);
    s.texelsChanged();
    return phat::traceLight(
        *s.lightPass, *s.light,
        {s.currentRayScene(), s.atlas, s.lookup, s.scene, s.currentShadows(), s.environmentTurn}, round);
}

void Renderer::filterLight() {
    filterIrradiance(*state_->lightPass, *state_->light, state_->atlas);
}

void Renderer::unboundLight() {
    unboundTiles(state_->lightPass->bounds);
}

void Renderer::boundLight() {
    State& s = *state_;
    boundTiles(s.lightPass->bounds, s.atlas, s.currentRayScene().brightest);
}

void Renderer::waitForLight() {
    glFinish();
}

StoredLight Renderer::readLight() const {
    return phat::readLight(state_->atlas);
}

void Renderer::turnEnvironment(int columns) {
    state_->environmentTurn = float(columns) / float(state_->environmentWidth);
}

int samplesToDraw(const FrameSettings& settings, const PictureSum& sum) {
    const int count = std::max(1, settings.samplesPerPixel);
    const bool continues = sum.size == sizeOf(settings) && sum.samples < count && !sum.preview;
    const int left = continues ? count - sum.samples : count;
    return settings.samplesPerDraw > 0 ? std::min(settings.samplesPerDraw, left) : left;
}

ReadCount countReads(const Image& picture, int source) {
    ReadCount count;
    size_t pixels = 0;
    for (const glm::vec3& pixel : picture.pixels) {
        if (pixel.x <= 0) continue;
        count.mean += double(pixel[source]);
        count.most = std::max(count.most, double(pixel[source]));
        ++pixels;
    }
    count.mean /= double(std::max<size_t>(pixels, 1));
    return count;
}

}  // namespace phat
