#pragma once
// A scene whose nodes move, with its texels, which move with their triangles.

#include <span>

#include "core/atlas/atlas.h"
#include "core/phatexel/tile_patch.h"
#include "core/scene/posed_scene.h"

namespace phat {

/// A box in which light may meet other surfaces than before, or surfaces that are lit differently.
struct SceneChange {
    /// Ordered: a box merged from several changes has the first of their kinds.
    enum class Kind : uint8_t {
        surface,     // a surface has moved or has another material
        lightRange,  // the region that a changed punctual light of limited range reaches
        wholeScene,  // a changed punctual light of unlimited range
    };
    uint64_t version = 0;  // of the scene that it led to
    Bounds box;
    Kind kind = Kind::surface;
};

/// A snapshot of the scene with its texels moved along. Motion is meant to be rigid: the atlas does not
/// follow a change of scale.
class DynamicScene {
  public:
    /// `points` of the scene at rest, states included. pre: all belong together, and `rest` is at rest.
    DynamicScene(SharedSnapshot rest, const Atlas& atlas, const TexelPoints& points);
    DynamicScene(const DynamicScene&) = delete;
    DynamicScene& operator=(const DynamicScene&) = delete;

    /// Returns what is different, but for the environment, which light is not updated for. If anything is,
    /// version() has grown and changes() has the boxes. pre: a snapshot of the same PosedScene.
    ChangedParts set(SharedSnapshot snapshot);

    /// A new version in which nothing is different.
    void beginVersion() { ++version_; }

    uint64_t version() const { return version_; }
    const Scene& scene() const { return now_->scene(); }
    const SceneSnapshot& snapshot() const { return *now_; }
    const Atlas& atlas() const { return atlas_; }
    const TexelPoints& points() const { return points_; }
    const std::vector<Frame>& frames() const { return frames_; }
    const std::vector<TilePatch>& patches() const { return patches_; }
    const std::vector<uint8_t>& irradianceTexels() const { return irradianceTexels_; }
    /// Grows when irradianceTexels changes.
    uint64_t texelsVersion() const { return texelsVersion_; }
    /// Version at which a chart last moved.
    uint64_t movedAt(uint32_t chart) const { return chartMoved_[chart]; }
    /// Oldest first; the oldest ones are merged.
    std::span<const SceneChange> changes() const { return changes_; }

    /// Tests again which of a tile's texels are occluded; safe for different tiles at a time.
    void markOccluded(size_t tile, const RayScene& rays);
    /// To be called for a tile after markOccluded, by one thread: whether any state has changed.
    bool commitOccluded(size_t tile);
    /// Ends such calls: if any has changed something, the scene is a new one.
    void endOccluded(bool anyChanged) { version_ += anyChanged; }

  private:
    void moveChart(const Chart& chart, const glm::mat4& worldFromRest);
    void addChange(const Bounds& box, SceneChange::Kind kind);
    void addReachOf(const PunctualLight& light, const Scene& scene);
    bool moveNodes(const SceneSnapshot& next);
    bool noteLights(const Scene& next);
    bool noteMaterials(const Scene& next);

    Atlas atlas_;
    SharedSnapshot now_;
    TexelPoints points_;
    std::vector<Frame> frames_;
    std::vector<TilePatch> patches_;

    TexelPoints restPoints_;
    std::vector<TexelState> restState_;
    std::vector<Frame> restFrames_;
    std::vector<TilePatch> restPatches_;

    std::vector<TexelState> committedState_;
    std::vector<uint8_t> irradianceTexels_;
    std::vector<uint32_t> surfaceTexels_;  // [chart], texels that are TexelState::surface
    std::vector<uint64_t> chartMoved_;
    std::vector<SceneChange> changes_;
    uint64_t version_ = 1, texelsVersion_ = 1;
};

}  // namespace phat
