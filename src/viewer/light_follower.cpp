#include "viewer/light_follower.h"

#include <fmt/format.h>

#include "io/phat/bake_record.h"
#include "viewer/sentence.h"
#include "viewer/window.h"

namespace phat {
namespace {

// Renewed PHATexels are uploaded for so long a frame.
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
    Document& document = *state.document;
    const bool renews = state.view.liveLight, refines = renews && state.view.refine && visible;
    try {
        if (!light_) {
            // Things that have moved need their places renewed, even where light waits.
            if (!document.isMoved() && !refines && (!renews || document.isAtRest())) return;
            begin(document);
            changed = true;
        }
        const Camera& eye = state.navigation.camera;
        const bool turned = eye.worldFromCamera != eye_ && !light_->report().converged;
        if (changed || turned || renews != renews_ || refines != refines_) {
            light_->follow(document.posed.snapshot(), eye, renews, refines);
            renews_ = renews;
            refines_ = refines;
            eye_ = eye.worldFromCamera;
        }
        state.refinements = light_->report().refinements;
        if (renewed_.empty()) {
            std::optional<LightUpdate> update = light_->take();
            if (!update) return;
            renewed_ = std::move(*update);
            document.takeLight(renewed_);
        }
    } catch (const std::exception& error) {
        state.message = fmt::format("Dynamic lighting failed: {}.", sentenceOf(error));
        light_.reset();
        failed_ = true;
        return;
    }
    const bool refined = renewed_.refined;
    state.renderer->takeUpdate(renewed_, kUploadSeconds);
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
