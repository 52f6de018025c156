#include "viewer/light_follower.h"

#include <fmt/format.h>

#include <utility>

#include "gl/gl_error.h"
#include "io/phat/bake_record.h"
#include "viewer/sentence.h"
#include "viewer/window.h"

namespace phat {
namespace {

// The time of uploads of updated PHATexels, per frame.
constexpr double kUploadSeconds = 0.004;

}  // namespace

void LightFollower::reset() {
    *this = {};
}

void LightFollower::begin(const Document& document) {
    const BakedScene& baked = document.baked;
    light_ = std::make_unique<BakerThread>(
        BakerThread::Start{document.posed.snapshotAtRest(), baked.atlas, baked.points, baked.phatexture,
                           settingsOf(baked.record)},
        0, Window::wake);
}

void LightFollower::follow(ViewerState& state, bool changed, bool visible) {
    if (failed_) return;
    try {
        const bool byGpu = state.lightEngine == LightEngine::gpu;
        followByBaker(state, changed, visible, !byGpu);
        roundsGoOn_ = byGpu && state.view.liveLight;
        roundsBehind_ |= changed;
        if (roundsGoOn_ && rounds_.follow(state, std::exchange(roundsBehind_, false))) ++state.lightVersion;
    } catch (const GlError&) {
        throw;
    } catch (const std::exception& error) {
        state.message = fmt::format("Dynamic lighting failed: {}.", sentenceOf(error));
        light_.reset();
        failed_ = true;
    }
}

void LightFollower::followByBaker(ViewerState& state, bool changed, bool visible, bool updatesLight) {
    Document& document = *state.document;
    const bool updates = updatesLight && state.view.liveLight,
               refines = updates && state.view.refine && visible;
    if (!light_) {
        // Moved objects need their positions updated, even where light waits.
        if (!document.isMoved() && !refines && (!updates || document.isAtRest())) return;
        begin(document);
        changed = true;
    }
    const Camera& eye = state.navigation.camera;
    const bool turned = eye.worldFromCamera != eye_ && !light_->report().converged;
    if (changed || turned || updates != updates_ || refines != refines_) {
        light_->follow(document.posed.snapshot(), eye, updates, refines);
        updates_ = updates;
        refines_ = refines;
        eye_ = eye.worldFromCamera;
    }
    state.refinements = light_->report().refinements;
    if (update_.empty()) {
        std::optional<LightUpdate> update = light_->take();
        if (!update) return;
        update_ = std::move(*update);
        document.takeLight(update_);
        // The baker, which updates nothing, knows the bounds of the light before alone.
        if (state.lightEngine == LightEngine::gpu) update_.tileLight.clear();
    }
    const bool refined = update_.refined;
    state.renderer->takeUpdate(update_, kUploadSeconds);
    // What is refined is averaged with what was there.
    if (!refined) ++state.lightVersion;
}

void LightFollower::waitUntilStarted() {
    if (light_) light_->waitUntilStarted();
}

std::optional<BakerThread::Report> LightFollower::report() const {
    if (!light_) return {};
    return light_->report();
}

}  // namespace phat
