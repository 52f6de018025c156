#pragma once
// The scene of the traced methods of `phat render`.

#include <memory>

#include "cli/render_options.h"
#include "core/base/progress.h"
#include "io/phat/scene_file.h"

namespace phat {

/// A scene with an integrator and all that it reads. Not movable: the integrator refers to its neighbours.
struct TracedScene {
    /// Loads, and bakes or traces photons where the method needs it.
    TracedScene(const RenderOptions& options, Progress& progress);
    TracedScene(const TracedScene&) = delete;
    TracedScene& operator=(const TracedScene&) = delete;

    SceneFile file;  // of methods without a bake the scene alone
    const BakedScene& baked;
    const Scene& scene;
    Scene viewedScene;  // with --keep-light, the scene with the edits that `scene` then lacks; else empty
    RayScene rays;
    LightSampler lights;
    PhotonMap photons;
    PhotonIndex index;
    double guideSeconds = 0;  // time to learn the guide:
    PathGuide guide;          // path
    Integrator integrator;
};

}  // namespace phat
