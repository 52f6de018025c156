#include "core/dynamic/tile_light_sender.h"

#include "core/phatexel/radiance_bound.h"
#include "core/scene/light_bound.h"

namespace phat {
namespace {

// Work between two computations of the bounds, in rays a texel.
constexpr uint64_t kTileLightWork = 1;

}  // namespace

void TileLightSender::addTo(LightUpdate& update, const BakerState& state, bool converged) {
    const Atlas& atlas = state.scene.atlas();
    const uint64_t version = state.scene.version();
    stale_ |= !update.phatexels.empty();
    const bool due = stale_ && (state.clock >= dueClock_ || converged);
    if (due || tileLight_.empty()) {
        tileLight_ = tileLight(state.scene.scene(), atlas, state.phatexture);
        stale_ = false;
        dueClock_ = state.clock + kTileLightWork * atlas.texelCount();
    }
    if (!due && sentVersion_ == version) return;
    sentVersion_ = version;
    update.tileLight = tileLight_;
    // Irradiance is updated before PHATexels are: those of an older scene must not bound it.
    for (size_t tile = 0; tile < tileLight_.size(); ++tile)
        if (atlas.tileChart[tile] != kNoChart &&
            state.blockAge[atlas.blockAt(state.cornerOfTile(tile))].scene != version)
            update.tileLight[tile] = glm::vec4(glm::vec3(kUnbounded), tileLight_[tile].a);
}

}  // namespace phat
