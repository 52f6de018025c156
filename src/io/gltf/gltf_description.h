#pragma once
// The JSON of a glTF file, checked, as a tinygltf model.
//
// tinygltf 2.7 believes what a file says: it reads pictures from views that it has not checked, allocates
// what a count claims, follows URIs, and takes a number that does not fit for another. So it gets the
// description only after the JSON has been bounded in depth and size, without buffers and images (which are
// ours to read), extras, animations and extensions that we do not know; and checkModel looks at every index
// after.

#include <tiny_gltf.h>

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "io/gltf/gltf_problem.h"

namespace phat::gltf {

struct ImageEntry {
    std::string name;
    std::string uri;
    int bufferView = -1;  // when there is no URI
};

/// A channel of an animation with its sampler, as the file has it: nothing is checked but the types.
struct ChannelEntry {
    int64_t node = -1, input = -1, output = -1;
    std::string path, interpolation;
};

struct AnimationEntry {
    std::string name;
    std::vector<ChannelEntry> channels;
};

struct Description {
    tinygltf::Model model;  // without buffers, images, animations, extras
    std::vector<AnimationEntry> animations;
    std::vector<ImageEntry> images;
};

/// Checks and prunes the file's JSON; names in `notes` each extension that is dropped. Throws Problem, also
/// for an extension that the file requires and that is not supported. pre: an object of bounded depth.
Description describe(const nlohmann::json& json, MemoryBudget& budget, Notes& notes);

}  // namespace phat::gltf
