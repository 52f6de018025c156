#include "viewer/pictures.h"

#include <epoxy/gl.h>

#include <algorithm>

#include "gl/textures.h"
#include "viewer/refine_plan.h"

namespace phat {
namespace {

// A still picture is this many samples a pixel.
constexpr int kStillSamples = 16;
// Of views whose cost is high or whose numbers must not be blended.
constexpr int kCountSamples = 1;
// Reads a pixel that are shown white; --quality high reads 137 in the mean.
constexpr float kMaxReads = 256;
// Rays of a still picture's first sample may take so long; the window does not answer meanwhile.
constexpr double kRaySeconds = 0.8;
// While something moves, pixels are left out so that a frame takes no longer than this.
constexpr double kMovingFrameSeconds = 0.04;
constexpr int kMaxCoarseness = 8;

int stillSamples(const ViewerState& state, Source source) {
    const Inspected what = state.view.inspection.what;
    const bool counts = what == Inspected::reads || what == Inspected::samples;
    return source == Source::phatexels && counts ? kCountSamples : kStillSamples;
}

GlTexture uploadPicture(const Image& image) {
    const glm::uvec2 size(uint32_t(image.width), uint32_t(image.height));
    GlTexture texture = createTexture2D(GL_RGB32F, size);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    // OpenGL's row 0 is the bottom.
    for (int y = 0; y < image.height; ++y)
        glTextureSubImage2D(texture.name(), 0, 0, image.height - 1 - y, image.width, 1, GL_RGB, GL_FLOAT,
                            image.pixels.data() + size_t(y) * size_t(image.width));
    return texture;
}

}  // namespace

Pictures::Pictures(const std::string& shaderFolder, Wake wake)
    : present_(createPresentPass(shaderFolder)), wake_(std::move(wake)) {}

void Pictures::reset() {
    path_.reset();
    reflections_.reset();
    sides_ = {};
    metrics_.reset();
    reads_.reset();
}

Pictures::Reads Pictures::readsOf(const Image& picture) {
    return {countReads(picture, 0), countReads(picture, 1)};
}

Pictures::SideReport Pictures::reportOf(const Side& side) {
    return {side.source == Source::pathTracer ? side.tracedSamples : side.drawn.samples, side.wanted};
}

int Pictures::coarsenessFor(glm::uvec2 size) const {
    // Nothing is known of the first frame.
    if (secondsPerPixel_ == 0) return 4;
    int coarseness = 1;
    while (coarseness < kMaxCoarseness &&
           secondsPerPixel_ * double(size.x) * double(size.y) > kMovingFrameSeconds * coarseness * coarseness)
        coarseness *= 2;
    return coarseness;
}

const TracedReflections& Pictures::reflections(const ViewerState& state, double seconds) {
    const Document& document = *state.document;
    if (!reflections_ || reflectionsVersion_ != document.rayVersion()) {
        reflections_.emplace(document);
        reflectionsVersion_ = document.rayVersion();
    }
    return reflections_->within(seconds);
}

bool Pictures::showsReflections(const ViewerState& state, const Side& side) const {
    return state.view.traced && (side.source == Source::phat || side.source == Source::direct);
}

bool Pictures::mayTrace(const ViewerState& state, const Side& side) const {
    return showsReflections(state, side) && !side.tooManyRays;
}

// At rest where the GPU is one; a moving view with as many rays as its time allows.
void Pictures::traceOnGpu(const ViewerState& state, const Side& side, bool atRest, FrameSettings& settings) {
    if (!showsReflections(state, side)) return;
    // The first picture does not wait for the rays' programs, which a software driver compiles when they
    // draw.
    if (!atRest && state.lastInput == std::chrono::steady_clock::time_point()) return;
    settings.tracedByGpu = Reflections::automatic;
    if (atRest) return;
    settings.rays = kRayLevels[size_t(rayLevel_)];
    if (settings.rays.maxPerPixel == 0) settings.tracedByGpu = Reflections::lookup;
    settings.seed = ++movingFrames_;
    // Two sides would take each other's frames for their last ones.
    settings.followsLast = !state.view.compare;
}

void Pictures::draw(ViewerState& state, Side& side, PictureSum& sum, glm::uvec2 size, int samplesPerPixel,
                    bool rays) {
    FrameSettings settings = frameSettings(state, side.source);
    settings.width = int(size.x);
    settings.height = int(size.y);
    settings.samplesPerPixel = samplesPerPixel;
    settings.samplesPerDraw = 1;
    settings.mayPreview = true;
    const bool byGpu = !rays || prefersGpuRays();
    if (byGpu) traceOnGpu(state, side, rays, settings);
    const TracedReflections* traced =
        byGpu ? nullptr : &reflections(state, sum.samples == 0 ? kRaySeconds : 0);
    side.wanted = samplesPerPixel;
    side.byRays = rays;
    side.counts = settings.inspection.what == Inspected::reads;
    side.light = showsLight(settings.inspection.what);
    try {
        reflectionSeconds_ = drawFrame(*state.renderer, settings, traced, sum).seconds;
    } catch (const Interrupted&) {
        // At once without them.
        side.tooManyRays = true;
        sum.samples = 0;
        return draw(state, side, sum, size, samplesPerPixel, false);
    }
    if (sum.preview) return;  // its times tell nothing of the next picture's
    frameTimes_ = state.renderer->lastFrameTimes();
    secondsPerPixel_ = frameTimes_.gpu() / (double(size.x) * double(size.y));
    coarseness_ = int(std::max(1u, size_.x / size.x));
    // Where pixels are left out, the lookup alone takes longer.
    if (!rays && coarseness_ == 1)
        rayLevel_ = nextRayLevel(rayLevel_, frameTimes_.gpu(), state.frameBudgetSeconds);
    if (side.counts && coarseness_ == 1 && side.drawn.samples == side.wanted)
        reads_ = readsOf(readMean(side.drawn));
}

// The picture that is there stays until another has been drawn by the light as it is now.
void Pictures::followLight(ViewerState& state, Side& side, bool rays) {
    if (side.next.samples == 0) side.nextLightVersion = state.lightVersion;
    draw(state, side, side.next, size_, side.wanted, rays);
    if (side.next.samples < std::min(kNewerSamples, side.wanted)) return;
    std::swap(side.drawn, side.next);
    side.next.samples = 0;
    side.lightVersion = side.nextLightVersion;
    side.refinements = state.refinements;
    metrics_.reset();
}

void Pictures::askPathTracer(const ViewerState& state, Side& side, glm::uvec2 size) {
    if (!path_) path_ = std::make_unique<PathPreview>(wake_);
    path_->show({state.navigation.camera, int(size.x), int(size.y), state.view.component,
                 state.document->posed.snapshot()});
    side.version = state.version;
    side.tracedSamples = 0;
    side.wanted = PathPreview::kMaxSamples;
    measuredSamples_ = 0;
}

void Pictures::takePathTracer(Side& side) {
    auto refined = path_ ? path_->take() : std::nullopt;
    if (!refined) return;
    side.traced = std::move(refined->mean);
    side.tracedTexture = uploadPicture(side.traced);
    side.tracedSamples = refined->samplesPerPixel;
}

bool Pictures::refine(ViewerState& state, glm::uvec2 size, std::chrono::steady_clock::time_point now) {
    if (state.version != version_ || size != size_) {
        version_ = state.version;
        lastChange_ = now;
        if (size != size_)
            for (Side& side : sides_) side.version = ~0ull;
        size_ = size;
        metrics_.reset();
    }
    const bool settled = now - lastChange_ >= kSettleTime;
    sides_[0].source = state.view.left;
    sides_[1].source = state.view.right;
    const size_t shown = state.view.compare ? 2 : 1;
    bool tracing = false, more = false;
    for (size_t i = 0; i < shown; ++i) {
        Side& side = sides_[i];
        const bool current = side.version == state.version && !side.drawn.preview;
        if (side.source == Source::pathTracer) {
            tracing = true;
            if (!current && settled) askPathTracer(state, side, size);
            more |= !current && !settled;
            takePathTracer(side);
            continue;
        }
        if (!state.renderer) continue;
        if (!current) side.tooManyRays = false;
        // As many samples of every pass of refined light.
        side.refinements = std::min(side.refinements, state.refinements);
        const RefineGoal goal{
            now - lastChange_, now - state.lastInput, mayTrace(state, side), coarsenessFor(size),
            stillSamples(state, side.source) * int(1 + state.refinements - side.refinements)};
        const RefinePlan plan =
            planRefinement({current, side.drawn.size == size, side.byRays,
                            side.lightVersion == state.lightVersion, side.drawn.samples, side.wanted},
                           goal);
        more |= plan.step != RefineStep::done;
        switch (plan.step) {
            case RefineStep::done:
            case RefineStep::wait:
                break;
            case RefineStep::relight:
                followLight(state, side, plan.trace);
                break;
            case RefineStep::restart:
                side.drawn.samples = side.next.samples = 0;
                side.lightVersion = state.lightVersion;
                side.refinements = state.refinements;
                side.version = state.version;
                [[fallthrough]];
            case RefineStep::addSample:
                draw(state, side, side.drawn, glm::max(size / uint32_t(plan.coarseness), glm::uvec2(1)),
                     plan.samples, plan.trace);
        }
    }
    if (!tracing && path_) path_->pause();
    measure(state);
    return more;
}

void Pictures::measure(const ViewerState& state) {
    if (measuring_.valid()) {
        if (measuring_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
        const Metrics metrics = measuring_.get();
        if (measuringVersion_ == state.version) metrics_ = metrics;
    }
    if (!state.view.compare) return;
    const auto ready = [&](const Side& side) {
        if (side.source == Source::phatexels) return false;  // not what the other side shows
        return side.source == Source::pathTracer
                   ? side.tracedSamples > 0
                   : side.drawn.size == size_ && side.drawn.samples == side.wanted;
    };
    const int samples = std::max(left().samples, right().samples);
    if (!ready(sides_[0]) || !ready(sides_[1]) || (metrics_ && samples < 2 * measuredSamples_)) return;
    measuredSamples_ = samples;
    measuringVersion_ = state.version;
    const auto picture = [](const Side& side) {
        return side.source == Source::pathTracer ? side.traced : readMean(side.drawn);
    };
    measuring_ =
        std::async(std::launch::async, [a = picture(sides_[0]), b = picture(sides_[1]), wake = wake_] {
            const Metrics metrics = compareImages(a, b);
            wake();
            return metrics;
        });
}

void Pictures::show(const ViewerState& state, glm::ivec4 area, int windowHeight) {
    const auto presented = [&](const Side& side) {
        if (side.source == Source::pathTracer && side.version == state.version && side.tracedSamples > 0)
            return Presented{side.tracedTexture.name()};
        return Presented{side.drawn.texture.name(), side.drawn.samples, side.light,
                         side.counts ? 1 / kMaxReads : 0.0f};
    };
    Presented left = presented(sides_[0]), right = state.view.compare ? presented(sides_[1]) : left;
    // Until the path tracer's first pass is there, the drawn picture stands in.
    if (left.texture == 0) left = right;
    if (right.texture == 0) right = left;
    if (left.texture == 0) return;
    PresentSettings settings;
    settings.toneMap = state.view.toneMap;
    settings.exposureStops = state.view.exposureStops;
    settings.wipe = state.view.compare ? state.view.wipe : 1.0f;
    settings.difference = state.view.compare && state.view.difference;
    // OpenGL's row 0 is the bottom.
    const glm::ivec4 viewport(area.x, windowHeight - area.y - area.w, area.z, area.w);
    present(present_, left, right, 0, viewport, settings);
}

}  // namespace phat
