#include "io/gltf/material_edit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cassert>
#include <cmath>
#include <cstdlib>
#include <set>
#include <stdexcept>

namespace phat {
namespace {

struct ScalarProperty {
    const char* name;
    float Material::*member;
    float low, high;
};
constexpr ScalarProperty kScalars[] = {
    {"metallic", &Material::metallic, 0, 1},
    {"roughness", &Material::roughness, 0, 1},
    {"specular", &Material::specular, 0, 1},
    {"ior", &Material::ior, 1, 10},
    {"normalScale", &Material::normalScale, 0, 10},
    {"clearcoat", &Material::clearcoat, 0, 1},
    {"clearcoatRoughness", &Material::clearcoatRoughness, 0, 1},
    {"transmission", &Material::transmission, 0, 1},
    {"thickness", &Material::thickness, 0, 1e9f},
    {"attenuationDistance", &Material::attenuationDistance, 1e-9f, 1e9f},
};

struct ColorProperty {
    const char* name;
    void (*set)(Material&, glm::vec3);
    glm::vec3 (*get)(const Material&);
    float high;
};
constexpr ColorProperty kColors[] = {
    {"baseColor", [](Material& m, glm::vec3 c) { m.baseColor = glm::vec4(c, m.baseColor.a); },
     [](const Material& m) { return glm::vec3(m.baseColor); }, 1},
    {"specularColor", [](Material& m, glm::vec3 c) { m.specularColor = c; },
     [](const Material& m) { return m.specularColor; }, 1},
    {"attenuationColor", [](Material& m, glm::vec3 c) { m.attenuationColor = c; },
     [](const Material& m) { return m.attenuationColor; }, 1},
    {"emission", [](Material& m, glm::vec3 c) { m.emission = c; },
     [](const Material& m) { return m.emission; }, 1e30f},
};

std::vector<float> parseNumbers(const std::string& text) {
    std::vector<float> numbers;
    const char* at = text.c_str();
    while (true) {
        char* end = nullptr;
        numbers.push_back(std::strtof(at, &end));
        if (end == at || !std::isfinite(numbers.back())) return {};
        if (*end == 0) return numbers;
        if (*end != ',') return {};
        at = end + 1;
    }
}

struct Assignment {
    std::string name, property, value;
};

// A name with "=" in it stands in double quotes, within which a backslash takes the next character as it is.
Assignment splitAssignment(const std::string& text) {
    Assignment parts;
    size_t start = 0;  // of what follows a quoted name
    if (text.starts_with('"')) {
        size_t at = 1;
        for (; at < text.size() && text[at] != '"'; ++at) {
            if (text[at] == '\\' && at + 1 < text.size()) ++at;
            parts.name += text[at];
        }
        start = at + 1;
    }
    const size_t equals = text.find('=', start);
    const size_t dot = equals == std::string::npos ? equals : text.rfind('.', equals);  // names may have dots
    const bool complete = equals != std::string::npos && dot != std::string::npos && dot >= start &&
                          (start == 0 || dot == start);
    if (!complete) throw std::invalid_argument(fmt::format("\"{}\" is not MATERIAL.property=value", text));
    if (start == 0) parts.name = text.substr(0, dot);
    parts.property = text.substr(dot + 1, equals - dot - 1);
    parts.value = text.substr(equals + 1);
    return parts;
}

// As splitAssignment reads it.
std::string quotedName(const std::string& name) {
    if (name.find('=') == std::string::npos && !name.starts_with('"')) return name;
    std::string quoted = "\"";
    for (const char c : name) {
        if (c == '"' || c == '\\') quoted += '\\';
        quoted += c;
    }
    return quoted + '"';
}

// Calls `apply` on the materials that are meant.
template <class Apply>
void forEachNamed(const std::string& name, std::vector<Material>& materials, const Apply& apply) {
    std::set<std::string> names;
    bool found = false;
    for (Material& material : materials) {
        names.insert(material.name);
        if (name != "*" && material.name != name) continue;
        apply(material);
        found = true;
    }
    if (!found)
        throw std::invalid_argument(
            fmt::format("there is no material \"{}\"; there are: {}", name, fmt::join(names, ", ")));
}

}  // namespace

void editMaterial(const std::string& assignment, std::vector<Material>& materials) {
    const Assignment parts = splitAssignment(assignment);
    const std::string &name = parts.name, &property = parts.property;
    const std::vector<float> numbers = parseNumbers(parts.value);
    const auto requireRange = [&](float low, float high) {
        for (const float number : numbers)
            if (!(number >= low && number <= high))
                throw std::invalid_argument(
                    fmt::format("{} of \"{}\" must be from {:g} to {:g}", property, assignment, low, high));
    };

    std::vector<std::string> known;
    for (const ScalarProperty& scalar : kScalars) {
        known.emplace_back(scalar.name);
        if (property != scalar.name) continue;
        if (numbers.size() != 1)
            throw std::invalid_argument(fmt::format("\"{}\" needs one number", assignment));
        requireRange(scalar.low, scalar.high);
        return forEachNamed(name, materials, [&](Material& m) { m.*scalar.member = numbers[0]; });
    }
    for (const ColorProperty& color : kColors) {
        known.emplace_back(color.name);
        if (property != color.name) continue;
        if (numbers.size() != 1 && numbers.size() != 3)
            throw std::invalid_argument(fmt::format("\"{}\" needs one number or three", assignment));
        requireRange(0, color.high);
        const glm::vec3 value =
            numbers.size() == 1 ? glm::vec3(numbers[0]) : glm::vec3(numbers[0], numbers[1], numbers[2]);
        return forEachNamed(name, materials, [&](Material& m) { color.set(m, value); });
    }
    throw std::invalid_argument(
        fmt::format("there is no property \"{}\"; there are: {}", property, fmt::join(known, ", ")));
}

std::vector<std::string> materialEdits(const std::vector<Material>& from, const std::vector<Material>& to) {
    assert(from.size() == to.size());
    std::vector<std::string> edits;
    for (size_t i = 0; i < from.size(); ++i) {
        for (const ScalarProperty& scalar : kScalars)
            if (from[i].*scalar.member != to[i].*scalar.member)
                edits.push_back(
                    fmt::format("{}.{}={}", quotedName(to[i].name), scalar.name, to[i].*scalar.member));
        for (const ColorProperty& color : kColors) {
            const glm::vec3 value = color.get(to[i]);
            if (color.get(from[i]) != value)
                edits.push_back(fmt::format("{}.{}={},{},{}", quotedName(to[i].name), color.name, value.x,
                                            value.y, value.z));
        }
    }
    return edits;
}

}  // namespace phat
