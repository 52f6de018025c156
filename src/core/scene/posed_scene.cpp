#include "core/scene/posed_scene.h"

#include <algorithm>

#include "core/scene/environment_sampling.h"
#include "core/scene/scene_motion.h"
#include "core/scene/transparency.h"

namespace phat {
namespace {

bool anySurfaceMoves(const Scene& rest, std::span<const glm::mat4> before, std::span<const glm::mat4> now) {
    return std::any_of(rest.surfaces.begin(), rest.surfaces.end(), [&](const Surface& surface) {
        return matrixAt(before, surface.node) != matrixAt(now, surface.node);
    });
}

}  // namespace

SceneSnapshot::SceneSnapshot(std::shared_ptr<const Scene> rest, std::shared_ptr<const Scene> scene,
                             std::vector<glm::mat4> worldFromRest, int environmentColumns,
                             std::shared_ptr<LazyBvh> bvh)
    : rest_(std::move(rest)),
      scene_(std::move(scene)),
      worldFromRest_(std::move(worldFromRest)),
      environmentColumns_(environmentColumns),
      bvh_(std::move(bvh)) {}

const RayScene& SceneSnapshot::rays() const {
    std::call_once(raysOnce_, [&] {
        std::call_once(bvh_->once, [&] { bvh_->bvh = RayScene::buildBvh(*scene_); });
        rays_.emplace(*scene_, bvh_->bvh);
    });
    return *rays_;
}

PosedScene::PosedScene(Scene read) {
    const auto rest = std::make_shared<const Scene>(std::move(read));
    now_.reset(new SceneSnapshot(rest, rest, {}, 0, std::make_shared<SceneSnapshot::LazyBvh>()));
}

SharedSnapshot PosedScene::snapshotAtRest() const {
    if (now_->scene_ == now_->rest_ && now_->worldFromRest_.empty()) return now_;
    const bool sameRays = !anySurfaceMoves(rest(), now_->worldFromRest_, {}) &&
                          hasTransparency(rest()) == hasTransparency(scene());
    return SharedSnapshot(new SceneSnapshot(
        now_->rest_, now_->rest_, {}, 0, sameRays ? now_->bvh_ : std::make_shared<SceneSnapshot::LazyBvh>()));
}

ChangedParts PosedScene::setState(const SceneState& state) {
    const Scene &before = scene(), &read = rest();
    std::vector<Material> materials = read.materials;
    std::copy_n(state.materials.begin(), std::min(state.materials.size(), materials.size()),
                materials.begin());
    std::vector<PunctualLight> lights = movedLights(state.lights, state.worldFromRest);
    const int columns = read.environment ? state.environmentColumns : 0;
    const ChangedParts changed{
        .nodes = anySurfaceMoves(read, now_->worldFromRest_, state.worldFromRest),
        .lights = lights != before.lights,
        .materials = materials != before.materials,
        .environment = columns != now_->environmentColumns_,
    };

    std::shared_ptr<const Scene> scene = now_->scene_;
    if (changed && columns == 0 && materials == read.materials && lights == read.lights &&
        !anySurfaceMoves(read, {}, state.worldFromRest)) {
        scene = now_->rest_;
    } else if (changed) {
        const auto next = std::make_shared<Scene>(before);
        next->materials = std::move(materials);
        next->lights = std::move(lights);
        if (changed.environment) next->environment = read.environment;
        if (columns != 0 && changed.environment) next->environment = turned(*read.environment, columns);
        moveSurfaces(read, now_->worldFromRest_, state.worldFromRest, *next);
        scene = next;
    }
    const bool sameRays = !changed.nodes && hasTransparency(*scene) == hasTransparency(before);
    now_.reset(new SceneSnapshot(now_->rest_, scene, state.worldFromRest, columns,
                                 sameRays ? now_->bvh_ : std::make_shared<SceneSnapshot::LazyBvh>()));
    return changed;
}

}  // namespace phat
