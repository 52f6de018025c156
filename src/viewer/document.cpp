#include "viewer/document.h"

#include "io/bake_record.h"
#include "io/baked_edits.h"
#include "io/scene_file.h"

namespace phat {
namespace {

void writeBake(const std::string& out, const std::string& source, const std::string& environment,
               BakedScene& baked) {
    Bake whole{std::move(baked.atlas), std::move(baked.points), std::move(baked.phatexture), {}};
    const auto giveBack = [&] {
        baked.atlas = std::move(whole.atlas);
        baked.points = std::move(whole.points);
        baked.phatexture = std::move(whole.phatexture);
    };
    try {
        BakeSettings settings;
        settings.atlas.texelBudget = whole.atlas.texelCount();
        writeBakedFile(out, source, baked.loaded.scene, whole, recordOf(settings, source, environment));
    } catch (...) {
        giveBack();
        throw;
    }
    giveBack();
}

}  // namespace

Document::Document(const std::string& file, const std::string& environment)
    : path(file),
      environmentPath(environment),
      baked(readSceneFile(file, environment)),
      hasBake(!baked.phatexture.indirect.empty()),
      shown(scene()),
      rays(shown),
      edits(noEdits(scene())),
      writeTime(std::filesystem::last_write_time(file)),
      applied_(edits.now()),
      inFile_(edits.now()) {}

void Document::showEdits() {
    applyEdits(applied_, edits.now(), shown);
    applied_ = edits.now();
}

std::string Document::save() {
    if (isBakedFile(path)) {
        writeEdits(path, path, inFile_, edits.now());
        inFile_ = edits.now();
        writeTime = std::filesystem::last_write_time(path);
        return path;
    }
    const std::string out = std::filesystem::path(path).replace_extension(".phat.glb").string();
    writeBake(out, path, environmentPath, baked);
    writeEdits(out, out, noEdits(scene()), edits.now());
    return out;
}

}  // namespace phat
