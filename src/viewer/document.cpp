#include "viewer/document.h"

#include <filesystem>

#include "io/scene_file.h"

namespace phat {
Document::Document(const std::string& file, const std::string& environmentPath)
    : path(file),
      baked(readSceneFile(file, environmentPath)),
      hasBake(!baked.phatexture.indirect.empty()),
      rays(scene()),
      edits({scene().materials, scene().lights}),
      writeTime(std::filesystem::last_write_time(file)) {}

}  // namespace phat
