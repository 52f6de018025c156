#pragma once
// Things that the window shows beside a bake.

#include <optional>

#include "gl/renderer.h"
#include "io/phat/added_things.h"
#include "viewer/document.h"

namespace phat {

class ThingsBeside {
  public:
    /// Throws FileError.
    explicit ThingsBeside(const std::vector<std::string>& paths) : loaded_(loadThings(paths)) {}

    /// What a renderer of the document's bake draws beside it; null where there is nothing. Makes the probes
    /// of a bake without, which takes seconds. It stays until the next call.
    const AddedThings* in(Document& document);

  private:
    LoadedThings loaded_;
    std::optional<AddedThings> added_;
};

}  // namespace phat
