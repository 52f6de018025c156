#include "gl/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/base/stopwatch.h"
#include "core/phatexel/lookup_tables.h"
#include "gl/display_pass.h"
#include "gl/gl_error.h"
#include "gl/phatexture_upload.h"
#include "gl/picture_sum.h"
#include "gl/reflection_pass.h"
#include "gl/relight_pass.h"
#include "gl/resident_bytes.h"
#include "gl/scene_upload.h"
#include "gl/shadow_maps.h"
#include "gl/textures.h"

namespace phat {
namespace {

bool anyBlended(const std::vector<Material>& materials) {
    return std::any_of(materials.begin(), materials.end(),
                       [](const Material& m) { return m.alphaMode == AlphaMode::blend; });
}

bool anyClearcoat(const std::vector<Material>& materials) {
    return std::any_of(materials.begin(), materials.end(), [](const Material& m) { return m.clearcoat > 0; });
}

void requireOpenGl45() {
    if (epoxy_gl_version() < 45 || !epoxy_is_desktop_gl())
        throw GlError(fmt::format("OpenGL 4.5 is needed, this driver offers {}",
                                  reinterpret_cast<const char*>(glGetString(GL_VERSION))));
}

double bytesOfPhatexel(const Phatexture& phatexture) {
    const double tiles = double(phatexture.tilePlaces.size()), layers = double(phatexture.indirect.size());
    const double texels = tiles * kTileSize * kTileSize;
    const double beside = double(phatexture.indirectGuides.size() * sizeof(Warp)) +
                          tiles * (sizeof(PackedTile) + kProbeSize * kProbeSize / 2);
    return sizeof(PackedPhatexel) + beside / (texels * layers);
}

}  // namespace

struct Renderer::State {
    /// The relit PHATexels and what they were relit for.
    struct Relit {
        RelightPass pass;
        bool materialsChanged = true;
        Eye eye;
    };

    std::string shaderFolder;
    // The scene as it is now, for what is made of it later.
    const Scene* shownScene = nullptr;
    const Atlas* shownAtlas = nullptr;
    const TexelPoints* shownPoints = nullptr;
    std::vector<Material> materials;
    std::vector<PunctualLight> lights;
    float environmentTurn = 0;
    int environmentWidth = 1;
    GpuScene scene;
    GpuAtlas atlas;
    GpuLookup lookup;
    ShadowMaps shadows;
    FrameTargets targets;
    PassClock clock;
    double bytesPerPhatexel = 0;
    ReflectionCost reflectionCost;

    // Made when they are first needed: compiling takes a while, and so do the texels' surfaces.
    std::optional<GpuTexelSurfaces> surfaces;
    bool surfacesTurned = false;
    std::optional<Relit> relit, relitPaper;
    std::optional<LookupPass> lookupPass, countingLookupPass;
    std::optional<ReflectionPass> reflectionPass;
    std::optional<DisplayPass> display, displayPaper, countingDisplay;
    std::optional<ShaderProgram> inspectProgram;

    Relit& relitFor(bool paper) {
        std::optional<Relit>& made = paper ? relitPaper : relit;
        if (!made)
            made.emplace().pass = createRelightPass(shaderFolder, atlas, anyClearcoat(materials), paper);
        return *made;
    }
    void show(const Scene& now, const Atlas& itsAtlas, const TexelPoints& points) {
        shownScene = &now;
        shownAtlas = &itsAtlas;
        shownPoints = &points;
    }
    /// What the pyramids are made of has changed.
    void texelsChanged() {
        for (auto* made : {&relit, &relitPaper})
            if (*made) (*made)->materialsChanged = true;
    }
    const GpuTexelSurfaces& surfacesNow() {
        if (!surfaces)
            surfaces = uploadTexelSurfaces(*shownScene, *shownAtlas, *shownPoints);
        else if (surfacesTurned)
            updateNormals(*surfaces, *shownScene, *shownAtlas, *shownPoints);
        surfacesTurned = false;
        return *surfaces;
    }
    /// The pyramid as it is seen from `from`.
    const RelightPass& renewed(bool paper, const Eye& from) {
        Relit& of = relitFor(paper);
        if (!of.materialsChanged && from.place == of.eye.place && from.atInfinity == of.eye.atInfinity)
            return of.pass;
        const GpuTexelSurfaces& under = surfacesNow();
        clock.ended(Pass::none);  // the CPU's work
        if (of.materialsChanged) applyMaterials(of.pass, atlas, under, materials);
        relight(of.pass, atlas, under, scene.splitSum.name(), from);
        clock.ended(Pass::relight);
        buildPyramid(of.pass, atlas);
        clock.ended(Pass::pyramid);
        of.materialsChanged = false;
        of.eye = from;
        return of.pass;
    }
    const LookupPass& lookupFor(bool counting) {
        std::optional<LookupPass>& made = counting ? countingLookupPass : lookupPass;
        if (!made) made = createLookupPass(shaderFolder, lookup, anyClearcoat(materials), counting);
        return *made;
    }
    const DisplayPass& displayFor(bool paper, bool counting) {
        std::optional<DisplayPass>& made = paper ? displayPaper : counting ? countingDisplay : display;
        if (!made) made = createDisplayPass(shaderFolder, atlas, anyClearcoat(materials), paper, counting);
        return *made;
    }
    const ReflectionPass& reflections() {
        if (!reflectionPass) reflectionPass = createReflectionPass(shaderFolder, anyClearcoat(materials));
        return *reflectionPass;
    }
    const ShaderProgram& inspecting() {
        if (!inspectProgram) inspectProgram.emplace(shaderFolder, "surface.vert", "inspect.frag");
        return *inspectProgram;
    }
    /// What of the settings this bake can show.
    FrameSettings possible(FrameSettings settings) const {
        const Inspected what = settings.inspection.what;
        // The views of the pyramid are of ours, not of the paper's.
        if (what == Inspected::reads)
            settings.method = Method::phat;
        else if (what != Inspected::nothing)
            settings.method = Method::phatPyramid;
        if (settings.method == Method::phat && lookup.guideCount == 0) settings.method = Method::phatPyramid;
        if (settings.method != Method::phat ||
            (settings.traced && settings.traced->reflections == Reflections::lookup))
            settings.traced = nullptr;
        return settings;
    }
    /// A clear coat changes what the shaders are made of.
    void dropPasses() {
        relit.reset(), relitPaper.reset();
        lookupPass.reset(), countingLookupPass.reset();
        reflectionPass.reset();
        display.reset(), displayPaper.reset(), countingDisplay.reset();
        targets = {};
    }
};

Renderer::Renderer(const RendererInput& input, const std::string& shaderFolder) {
    requireOpenGl45();
    state_ = std::make_unique<State>();
    state_->shaderFolder = shaderFolder;
    state_->show(input.scene, input.atlas, input.points);
    state_->materials = input.scene.materials;
    state_->lights = input.scene.lights;
    state_->scene = uploadScene(input.scene, input.atlas);
    state_->atlas = uploadAtlas(input.scene, input.atlas, input.phatexture);
    state_->lookup = uploadLookup(input.phatexture, input.atlas);
    if (state_->lookup.guideCount > 0) state_->bytesPerPhatexel = bytesOfPhatexel(input.phatexture);
    if (input.scene.environment) state_->environmentWidth = input.scene.environment->radiance.width;
    // What cannot be compiled is told now.
    state_->displayFor(false, false);
    if (state_->lookup.guideCount > 0) state_->lookupFor(false);
}

Renderer::~Renderer() = default;

void Renderer::draw(const FrameSettings& wanted, PictureSum& sum) {
    State& s = *state_;
    const FrameSettings settings = s.possible(wanted);
    const Inspected what = settings.inspection.what;
    const bool lookedUp = settings.method == Method::phat, paper = settings.method == Method::phatPaper;
    const bool counting = lookedUp && what == Inspected::reads;
    const LookupPass* lookupPass = s.lookup.guideCount > 0 ? &s.lookupFor(counting) : nullptr;
    const ReflectionPass* reflectionPass = settings.traced ? &s.reflections() : nullptr;
    const DisplayPass& displayPass = s.displayFor(paper, counting);

    const glm::uvec2 size(std::max(settings.width, 1), std::max(settings.height, 1));
    if (s.targets.size != size || (reflectionPass && !s.targets.reflections.target))
        s.targets = createFrameTargets(size, lookupPass, reflectionPass != nullptr);
    if (sum.size != size) sum = createPictureSum(size);

    // A query needs a complete framebuffer; a context without a window has none of its own.
    glBindFramebuffer(GL_FRAMEBUFFER, sum.target.name());
    s.clock.restart();
    glDisable(GL_BLEND);
    if (!s.shadows.depth) {
        s.shadows = renderShadowMaps(s.lights, s.scene, s.materials, displayPass.depthProgram);
        s.clock.ended(Pass::shadows);
    }
    const RelightPass* relit = nullptr;
    if (!lookedUp || anyBlended(s.materials)) relit = &s.renewed(paper, eyeOf(settings.camera));
    const bool texelsShown = what != Inspected::nothing && what != Inspected::reads;
    filterTextures(s.scene, settings.filter);
    s.reflectionCost =
        display(displayPass,
                {s.scene, s.atlas, s.shadows, s.lookup, s.materials, relit, lookupPass, reflectionPass,
                 texelsShown ? &s.inspecting() : nullptr, s.clock, s.environmentTurn},
                settings, s.targets, sum);
    checkGl("drawing a frame");
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
    times.lookup = clock.seconds(Pass::lookup);
    times.pool = clock.seconds(Pass::pool);
    times.display = clock.seconds(Pass::display);
    times.reflections = state_->reflectionCost.seconds;
    times.reflectionRays = state_->reflectionCost.rays;
    return times;
}

double Renderer::bytesPerPhatexel() const {
    return state_->bytesPerPhatexel;
}

ResidentBytes Renderer::residentBytes() const {
    const State& s = *state_;
    ResidentBytes bytes = residentBytesOf(s.scene, s.atlas, s.lookup, s.shadows, s.targets);
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
    s.materials = materials;
    s.texelsChanged();
    if (coatAppears) s.dropPasses();
}

void Renderer::setLights(const std::vector<PunctualLight>& lights) {
    state_->lights = lights;
    state_->shadows = {};
}

void Renderer::moveScene(const Scene& scene, const Atlas& atlas, const TexelPoints& points) {
    State& s = *state_;
    phat::moveScene(s.scene, scene, atlas);
    s.show(scene, atlas, points);
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
    for (const LightUpdate::Place& place : update.places) {
        updatePlace(s.atlas, place);
        if (s.lookup.guideCount > 0) updateProbe(s.lookup, place, tiles);
    }
    update.places.clear();
    if (!update.tileLight.empty()) updateTileLight(s.atlas, update.tileLight);
    update.tileLight.clear();
    update.covers.clear();

    // One portion at least, so that however little time there is, all is done one day.
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
    checkGl("taking over renewed PHATexels");
    return update.empty();
}

void Renderer::turnEnvironment(int columns) {
    state_->environmentTurn = float(columns) / float(state_->environmentWidth);
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
