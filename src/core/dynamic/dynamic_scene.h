#pragma once
// A scene whose nodes move, with its texels, which move with their triangles.

#include <span>

#include "core/atlas/atlas.h"
#include "core/phatexel/tile_patch.h"

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

/// The state of the scene that may differ from the scene at rest.
struct SceneState {
    std::vector<glm::mat4> worldFromRest;  // [glTF node]; of nodes beyond its end: identity
    std::vector<PunctualLight> lights;     // all of them, where they are at rest: their nodes carry them
    std::vector<Material> materials;       // those beyond its end: as at rest
};

/// Which parts of a scene are different.
struct ChangedParts {
    bool nodes = false, lights = false, materials = false;
    explicit operator bool() const { return nodes || lights || materials; }
};

/// The scene as it is now. Motion is meant to be rigid: the atlas does not follow a change of scale.
class DynamicScene {
  public:
    /// `points` of the scene at rest, states included. pre: all belong together.
    DynamicScene(const Scene& rest, const Atlas& atlas, const TexelPoints& points);
    DynamicScene(const DynamicScene&) = delete;
    DynamicScene& operator=(const DynamicScene&) = delete;

    /// Returns the differences. If there are any, version() has grown and changes() has the boxes.
    ChangedParts set(const SceneState& state);

    /// A new version in which nothing is different.
    void beginVersion() { ++version_; }

    uint64_t version() const { return version_; }
    const Scene& scene() const { return scene_; }
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
    void addReachOf(const PunctualLight& light);
    Bounds boundsOfSurface(const Surface& surface) const;
    bool setNodes(const std::vector<glm::mat4>& worldFromRest);
    bool setLights(const std::vector<PunctualLight>& lights);
    bool setMaterials(const std::vector<Material>& materials);

    Atlas atlas_;
    Scene scene_;
    TexelPoints points_;
    std::vector<Frame> frames_;
    std::vector<TilePatch> patches_;

    std::vector<glm::vec3> restPositions_, restNormals_;  // of vertices
    std::vector<glm::vec4> restTangents_;
    std::vector<Material> restMaterials_;
    std::vector<glm::mat4> worldFromRest_;
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
