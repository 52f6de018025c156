#include "viewer/document.h"

#include <algorithm>
#include <cassert>
#include <system_error>

#include "core/scene/animation.h"
#include "io/phat/bake_record.h"
#include "io/phat/baked_edits.h"

namespace phat {
namespace {

// Of a file that is gone, none that a file has: reading it says what is wrong.
std::filesystem::file_time_type lastWrite(const std::string& path) {
    std::error_code gone;
    return std::filesystem::last_write_time(path, gone);
}

void writeBake(const std::string& out, const Document& document, BakedScene& baked) {
    Bake whole{std::move(baked.atlas), std::move(baked.points), std::move(baked.phatexture), {}};
    const auto giveBack = [&] {
        baked.atlas = std::move(whole.atlas);
        baked.points = std::move(whole.points);
        baked.phatexture = std::move(whole.phatexture);
    };
    try {
        writeBakedFile(out, document.path, document.scene(), whole, baked.record, {document.variant});
    } catch (...) {
        giveBack();
        throw;
    }
    giveBack();
}

}  // namespace

Document::Document(const std::string& file, const SceneLighting& asked, const std::string& look)
    : Document(file, asked, look, readSceneFile(file, asked, {look}), lastWrite(file)) {}

Document::Document(const std::string& file, const SceneLighting& asked, const std::string& look,
                   SceneFile read, std::filesystem::file_time_type time)
    : path(file),
      lighting(asked),
      variant(look),
      added(std::move(read.added)),
      writeTime(time),
      baked(std::move(read.baked)),
      posed(std::move(baked.loaded.scene)),
      hasBake(!baked.phatexture.indirect.empty()),
      edits(noEdits(scene())),
      inFile_(edits.now()) {
    added.bvh.reset();  // the snapshots of the scene have their own
}

const SceneBvh* Document::bvh() {
    return bvhOf(scene(), baked.bvh);
}

Document::Changes Document::show() {
    if (edits.revision() == shownRevision_ && playback.animation == shownPlayback_.animation &&
        playback.seconds == shownPlayback_.seconds)
        return {};
    shownRevision_ = edits.revision();
    shownPlayback_ = playback;
    std::vector<glm::mat4> animated;
    if (playback.animation >= 0)
        animated =
            worldFromRest(scene().nodes, scene().animations[size_t(playback.animation)], playback.seconds);
    const SceneEdits& now = edits.now();
    const ChangedParts changed = posed.setState({withMotions(scene().nodes, std::move(animated), now.motions),
                                                 now.lights, now.materials, now.environmentColumns});
    ++rayVersion_;
    return {true, changed.nodes};
}

bool Document::isAtRest() const {
    const std::vector<glm::mat4>& moved = posed.snapshot()->worldFromRest();
    return shown().materials == scene().materials && shown().lights == scene().lights &&
           std::all_of(moved.begin(), moved.end(), [](const glm::mat4& m) { return m == glm::mat4(1); });
}

void Document::takeBake(Bake bake, const BakeSettings& settings) {
    baked.atlas = std::move(bake.atlas);
    baked.points = std::move(bake.points);
    baked.phatexture = std::move(bake.phatexture);
    baked.record = recordOf(settings, path, lighting.environment, PhatexelStorage::packed, variant);
    baked.record.settings = settingsWithLighting(baked.record.settings, lighting, added.sky);
    baked.probes = {};  // those of another bake
    hasBake = true;
}

void Document::takeLight(const LightUpdate& update) {
    if (!bakedLight_) bakedLight_ = BakedLight{baked.phatexture, baked.points.state};
    rayVersion_ += !update.occlusions.empty();
    applyUpdate(update, baked.atlas, baked.phatexture, baked.points.state);
}

std::string Document::save() {
    assert(hasBake);
    if (isBakedFile(path)) {
        writeEdits(path, path, inFile_, edits.now());
        inFile_ = edits.now();
        writeTime = lastWrite(path);
        return path;
    }
    const std::string out = std::filesystem::path(path).replace_extension(".phat.glb").string();
    const auto swapLight = [&] {
        if (!bakedLight_) return;
        std::swap(bakedLight_->phatexture, baked.phatexture);
        std::swap(bakedLight_->states, baked.points.state);
    };
    swapLight();
    try {
        writeBake(out, *this, baked);
    } catch (...) {
        swapLight();
        throw;
    }
    swapLight();
    writeEdits(out, out, noEdits(scene()), edits.now());
    return out;
}

}  // namespace phat
