#pragma once
// Names of the values of render flags: `phat render` reads them, the window writes them.

#include <algorithm>
#include <array>
#include <cassert>
#include <string>
#include <string_view>
#include <vector>

#include "core/render/picture.h"
#include "gl/renderer.h"

namespace phat {

template <class Value>
struct FlagName {
    const char* name;
    Value value;
};

inline constexpr std::array<FlagName<Component>, 5> kComponentNames = {
    {{"all", Component::all},
     {"direct", Component::direct},
     {"indirect", Component::indirect},
     {"glossy-indirect", Component::glossyIndirect},
     {"diffuse-indirect", Component::diffuseIndirect}}};
inline constexpr std::array<FlagName<ToneMap>, 3> kToneMapNames = {
    {{"linear", ToneMap::linear}, {"agx", ToneMap::agx}, {"aces", ToneMap::aces}}};
inline constexpr std::array<FlagName<Quality>, 3> kQualityNames = {
    {{"fast", Quality::fast}, {"default", Quality::standard}, {"high", Quality::high}}};
inline constexpr std::array<FlagName<Reflections>, 3> kReflectionNames = {
    {{"auto", Reflections::automatic}, {"rays", Reflections::rays}, {"lookup", Reflections::lookup}}};

/// pre: the value is in the table.
template <class Value, size_t n>
constexpr const char* nameOf(const std::array<FlagName<Value>, n>& table, Value value) {
    assert(std::any_of(table.begin(), table.end(), [&](const auto& entry) { return entry.value == value; }));
    return std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.value == value; })
        ->name;
}

/// pre: the name is in the table.
template <class Value, size_t n>
constexpr Value valueOf(const std::array<FlagName<Value>, n>& table, std::string_view name) {
    assert(std::any_of(table.begin(), table.end(), [&](const auto& entry) { return entry.name == name; }));
    return std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.name == name; })
        ->value;
}

template <class Value, size_t n>
std::vector<std::string> namesOf(const std::array<FlagName<Value>, n>& table) {
    std::vector<std::string> names;
    for (const auto& entry : table) names.push_back(entry.name);
    return names;
}

}  // namespace phat
