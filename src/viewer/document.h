#pragma once
// An open file.

#include <filesystem>
#include <optional>
#include <string>

#include "core/dynamic/light_update.h"
#include "core/scene/posed_scene.h"
#include "io/phat/scene_file.h"
#include "viewer/edit_history.h"

namespace phat {

/// The state of the file's animation.
struct Playback {
    int animation = -1;  // -1: at rest
    double seconds = 0;
    bool playing = false;

    bool operator==(const Playback&) const = default;
};

struct Document {
    /// A baked file, or a scene without its bake, which is lit and has the materials of `variant`, if one is
    /// named. Throws FileError.
    Document(const std::string& path, const SceneLighting& lighting, const std::string& variant = {});
    Document(const Document&) = delete;
    Document& operator=(const Document&) = delete;

    /// As it was read; what a bake in the background works on.
    const Scene& scene() const { return posed.rest(); }
    /// With the edits, and moved.
    const Scene& shown() const { return posed.scene(); }
    struct Changes {
        bool any = false, moved = false;
    };
    /// Brings shown() to the edits and the time of now; tells what was different.
    Changes show();
    /// Whether things may be elsewhere than at rest.
    bool isMoved() const { return !posed.snapshot()->worldFromRest().empty(); }
    /// Whether all is as the file has it.
    bool isAtRest() const;
    /// Of shown(): for picking.
    const RayScene& rays() const { return posed.snapshot()->rays(); }
    /// Of scene(), for rays on the GPU; null where it is too large for them. Built when it is first asked
    /// for, unless the file has it.
    const SceneBvh* bvh();
    /// Grows when what rays meet, or may read there, is another.
    uint64_t rayVersion() const { return rayVersion_; }
    /// Takes over a bake of scene() that was made with `settings`, which save() records.
    void takeBake(Bake bake, const BakeSettings& settings);
    /// Takes over a part of the bake that was updated; the file's is kept aside.
    void takeLight(const LightUpdate& update);
    /// Drops the file's own light: the bake is another one.
    void forgetUpdatedLight() { bakedLight_.reset(); }
    /// Writes the edits of materials, lights' colours and environment into the baked file; a bake that was
    /// made here goes beside its scene first, as it was made. Returns the file's path. Throws FileError. pre:
    /// hasBake.
    std::string save();

    std::string path;
    SceneLighting lighting;
    std::string variant;  // of the materials; empty: none was asked for
    AddedLighting added;
    std::filesystem::file_time_type writeTime;  // of the file before it was read, so that no change is missed
    BakedScene baked;  // without its scene, which is in `posed`; PHATexels and covered texels as renewed
    PosedScene posed;
    bool hasBake = false;
    EditHistory edits;
    Playback playback;

  private:
    Document(const std::string& path, const SceneLighting& lighting, const std::string& variant,
             SceneFile file, std::filesystem::file_time_type writeTime);
    struct BakedLight {
        Phatexture phatexture;
        std::vector<TexelState> states;
    };
    uint64_t shownRevision_ = 0, rayVersion_ = 0;
    Playback shownPlayback_;
    std::optional<BakedLight> bakedLight_;
    SceneEdits inFile_;
};

}  // namespace phat
