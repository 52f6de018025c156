#include "gl/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "core/lookup_tables.h"
#include "gl/display_pass.h"
#include "gl/gl_error.h"
#include "gl/phatexture_upload.h"
#include "gl/picture_sum.h"
#include "gl/reflection_pass.h"
#include "gl/relight_pass.h"
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

// Seconds on the GPU of whatever runs between construction and stop().
class PassTimer {
  public:
    PassTimer() {
        GLuint name = 0;
        glCreateQueries(GL_TIME_ELAPSED, 1, &name);
        query_ = GlQuery(name);
    }
    void start() { glBeginQuery(GL_TIME_ELAPSED, query_.name()); }
    void stop() { glEndQuery(GL_TIME_ELAPSED); }
    /// Waits for the GPU.
    double seconds() const {
        GLuint64 nanoseconds = 0;
        glGetQueryObjectui64v(query_.name(), GL_QUERY_RESULT, &nanoseconds);
        return double(nanoseconds) * 1e-9;
    }

  private:
    GlQuery query_;
};

double bytesOfPhatexel(const Phatexture& phatexture) {
    const double tiles = double(phatexture.tilePlaces.size()), layers = double(phatexture.indirect.size());
    const double texels = tiles * kTileSize * kTileSize;
    const double beside = double(phatexture.indirectGuides.size() * sizeof(Warp)) +
                          tiles * (sizeof(PackedTile) + kProbeSize * kProbeSize / 2);
    return sizeof(PackedPhatexel) + beside / (texels * layers);
}

}  // namespace

struct Renderer::State {
    std::string shaderFolder;
    std::vector<Material> materials;
    std::vector<PunctualLight> lights;
    GpuScene scene;
    GpuAtlas atlas;
    GpuLookup lookup;
    RelightPass relight;
    LookupPass lookupPass;
    ReflectionPass reflectionPass;
    DisplayPass display;
    ShadowMaps shadows;
    FrameTargets targets;
    PassTimer relightTimer, pyramidTimer, shadowTimer, displayTimer;
    double bytesPerPhatexel = 0;
    bool countReads = false;
    bool shadowsDrawn = false;  // by the last frame
    ReflectionCost reflections;
    bool materialsChanged = true;
    std::optional<Eye> relitFor;  // what the pyramid holds

    void createPasses(bool paper) {
        const bool clearcoat = anyClearcoat(materials);
        relight = createRelightPass(shaderFolder, atlas, clearcoat, paper);
        if (lookup.guideCount > 0)
            lookupPass = createLookupPass(shaderFolder, lookup, clearcoat, countReads);
        reflectionPass = createReflectionPass(shaderFolder, clearcoat);
        targets = {};
        display = createDisplayPass(shaderFolder, atlas, clearcoat, paper, countReads);
        materialsChanged = true;
    }
};

Renderer::Renderer(const RendererInput& input, const std::string& shaderFolder) {
    requireOpenGl45();
    state_ = std::make_unique<State>();
    state_->shaderFolder = shaderFolder;
    state_->materials = input.scene.materials;
    state_->lights = input.scene.lights;
    state_->scene = uploadScene(input.scene, input.atlas);
    state_->countReads = input.countReads;
    state_->atlas = uploadAtlas(input.scene, input.atlas, input.points, input.phatexture);
    state_->lookup = uploadLookup(input.phatexture, input.atlas);
    if (state_->lookup.guideCount > 0) state_->bytesPerPhatexel = bytesOfPhatexel(input.phatexture);
    state_->createPasses(false);
}

Renderer::~Renderer() = default;

void Renderer::draw(const FrameSettings& wanted, PictureSum& sum) {
    State& s = *state_;
    FrameSettings settings = wanted;
    const bool canLookUp = s.lookup.guideCount > 0;
    if (!canLookUp && settings.method == Method::phat) settings.method = Method::phatPyramid;
    const bool pyramid = settings.method != Method::phat || anyBlended(s.materials);
    if (const bool paper = settings.method == Method::phatPaper; paper != s.relight.paper)
        s.createPasses(paper);
    const glm::uvec2 size(std::max(settings.width, 1), std::max(settings.height, 1));
    const bool traced = settings.traced && settings.method == Method::phat;
    if (s.targets.size != size || (traced && !s.targets.reflections.target))
        s.targets = createFrameTargets(size, canLookUp ? &s.lookupPass : nullptr, traced);
    if (sum.size != size) sum = createPictureSum(size);

    // A query needs a complete framebuffer; a context without a window has none of its own.
    glBindFramebuffer(GL_FRAMEBUFFER, sum.target.name());

    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    const Eye eye = eyeOf(settings.camera);
    const bool relit =
        !s.materialsChanged && s.relitFor && eye.place == s.relitFor->place && eye.atInfinity == s.relitFor->atInfinity;
    const bool relighting = pyramid && !relit;

    s.shadowsDrawn = !s.shadows.depth;
    if (s.shadowsDrawn) {
        s.shadowTimer.start();
        s.shadows = renderShadowMaps(s.lights, s.scene, s.materials, s.display.depthProgram);
        s.shadowTimer.stop();
    }

    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    s.relightTimer.start();
    if (relighting) {
        if (s.materialsChanged) applyMaterials(s.relight, s.atlas, s.materials);
        relight(s.relight, s.atlas, s.scene.splitSum.name(), eye);
        s.materialsChanged = false;
        s.relitFor = eye;
    }
    s.relightTimer.stop();
    s.pyramidTimer.start();
    if (relighting) buildPyramid(s.relight, s.atlas);
    s.pyramidTimer.stop();

    s.displayTimer.start();
    s.reflections = phat::display(
        s.display,
        {s.scene, s.atlas, s.relight, s.shadows, s.lookup, s.lookupPass, s.reflectionPass, s.materials},
        settings, s.targets, sum);
    s.displayTimer.stop();
    checkGl("drawing a frame");
}

Image Renderer::render(const FrameSettings& settings) {
    PictureSum sum;
    draw(settings, sum);
    return readMean(sum);
}

FrameTimes Renderer::lastFrameTimes() const {
    const State& s = *state_;
    // The GPU's clock goes on while the CPU traces.
    return {s.relightTimer.seconds(),
            s.pyramidTimer.seconds(),
            s.shadowsDrawn ? s.shadowTimer.seconds() : 0.0,
            std::max(s.displayTimer.seconds() - s.reflections.seconds, 0.0),
            s.reflections.seconds,
            s.reflections.rays};
}

double Renderer::bytesPerPhatexel() const {
    return state_->bytesPerPhatexel;
}

void Renderer::setMaterials(const std::vector<Material>& materials) {
    State& s = *state_;
    if (materials.size() != s.materials.size())
        throw GlError("materials may be changed, not added or removed");
    const bool coatAppears = anyClearcoat(materials) && !s.relight.clearcoat;
    s.materials = materials;
    s.materialsChanged = true;
    if (coatAppears) s.createPasses(s.relight.paper);
}

void Renderer::setLights(const std::vector<PunctualLight>& lights) {
    state_->lights = lights;
    state_->shadows = {};
}

void Renderer::moveScene(const Scene& scene, const Atlas& atlas, const TexelPoints& points) {
    State& s = *state_;
    phat::moveScene(s.scene, scene, atlas);
    // The passes over all texels read their normals; the lookup does not.
    if (anyBlended(s.materials)) updateNormals(s.atlas, scene, atlas, points);
    s.lights = scene.lights;
    s.shadows = {};
    s.materialsChanged = true;
}

bool Renderer::takeUpdate(LiveUpdate& update, double seconds) {
    State& s = *state_;
    const auto start = std::chrono::steady_clock::now();
    const auto late = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > seconds;
    };
    if (!update.empty()) s.materialsChanged = true;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    const glm::uvec2 tiles = s.atlas.sizeTexels / kTileSize;
    for (const LiveUpdate::Place& place : update.places) {
        updatePlace(s.atlas, place);
        if (s.lookup.guideCount > 0) updateProbe(s.lookup, place, tiles);
    }
    update.places.clear();
    if (!update.tileLight.empty()) updateTileLight(s.atlas, update.tileLight);
    update.tileLight.clear();

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

}  // namespace phat
