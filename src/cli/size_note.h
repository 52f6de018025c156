#pragma once
// A note on scenes of an unlikely size or place.

#include <optional>
#include <string>

#include "core/scene/scene.h"

namespace phat {

/// What to say of a scene that, without its ground, is more than a kilometre across, or with it less than
/// five centimetres: its picture is right, but its lengths seem to be in another unit than glTF's metre.
/// Or of one so far from its origin that floats hold its positions to a thousandth of it only: surfaces near
/// each other merge there.
std::optional<std::string> sizeNote(const Scene& scene);

}  // namespace phat
