#pragma once
// The scene as it is now: what was read from a file, with its nodes, materials, lights and sky as they have
// been changed since. Whoever draws it, picks from it or bakes it again reads the same snapshots.

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/scene/rays.h"
#include "core/scene/scene.h"

namespace phat {

/// What may differ from the scene at rest.
struct SceneState {
    std::vector<glm::mat4> worldFromRest;  // [glTF node]; of nodes beyond its end: identity
    std::vector<PunctualLight> lights;     // all of them, where they are at rest: their nodes carry them
    std::vector<Material> materials;       // those beyond its end: as at rest
    int environmentColumns = 0;            // by which the sky is turned, see turned()
};

/// Which parts of a scene are different.
struct ChangedParts {
    bool nodes = false, lights = false, materials = false, environment = false;
    explicit operator bool() const { return nodes || lights || materials || environment; }
};

/// The scene in one state. Nothing in it ever changes, so that any thread may read it for as long as it
/// keeps it. Textures are those of all other snapshots.
class SceneSnapshot {
  public:
    SceneSnapshot(const SceneSnapshot&) = delete;
    SceneSnapshot& operator=(const SceneSnapshot&) = delete;

    const Scene& scene() const { return *scene_; }
    const Scene& rest() const { return *rest_; }
    /// As SceneState has it.
    const std::vector<glm::mat4>& worldFromRest() const { return worldFromRest_; }
    /// Of scene(). The acceleration structure is built when it is first asked for, by whichever thread asks;
    /// snapshots between which nothing has moved share it.
    const RayScene& rays() const;

  private:
    friend class PosedScene;
    struct LazyBvh {
        std::once_flag once;
        std::shared_ptr<const RayScene::Bvh> bvh;
    };
    SceneSnapshot(std::shared_ptr<const Scene> rest, std::shared_ptr<const Scene> scene,
                  std::vector<glm::mat4> worldFromRest, int environmentColumns, std::shared_ptr<LazyBvh> bvh);

    std::shared_ptr<const Scene> rest_, scene_;
    std::vector<glm::mat4> worldFromRest_;
    int environmentColumns_;
    std::shared_ptr<LazyBvh> bvh_;
    mutable std::once_flag raysOnce_;
    mutable std::optional<RayScene> rays_;
};

using SharedSnapshot = std::shared_ptr<const SceneSnapshot>;

/// To be used by one thread; its snapshots go to any.
class PosedScene {
  public:
    /// At rest.
    explicit PosedScene(Scene rest);

    const Scene& rest() const { return now_->rest(); }
    const Scene& scene() const { return now_->scene(); }
    /// As it is now. It stays as it is when the state changes.
    const SharedSnapshot& snapshot() const { return now_; }
    /// As it was read.
    SharedSnapshot snapshotAtRest() const;

    /// Brings the scene to `state`; returns what is different. Rays need another acceleration structure only
    /// where surfaces have moved, or where transparency has appeared or disappeared: they read all else from
    /// the scene.
    ChangedParts setState(const SceneState& state);

  private:
    SharedSnapshot now_;
};

}  // namespace phat
