#include "io/phat/baked_inputs.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace phat {

using nlohmann::json;

namespace {

// JSON's numbers do not hold 64 bits everywhere.
uint64_t readKey(const json& object, const char* name) {
    const auto found = object.find(name);
    if (found == object.end() || !found->is_string()) return 0;
    const auto& text = found->get_ref<const std::string&>();
    uint64_t key = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), key, 16);
    return error == std::errc() && end == text.data() + text.size() ? key : 0;
}

}  // namespace

json describeInputs(const BakedInputs& inputs) {
    const auto hex = [](uint64_t key) { return fmt::format("{:016x}", key); };
    return {
        {"wallTexelSize", inputs.wallTexelSizeMeters}, {"all", hex(inputs.keys.all)},
        {"geometry", hex(inputs.keys.geometry)},       {"areaIrradiance", hex(inputs.keys.areaIrradiance)},
        {"areaLight", hex(inputs.keys.areaLight)},     {"probes", hex(inputs.probes)}};
}

BakedInputs readInputs(const json& object) {
    BakedInputs inputs;
    if (!object.is_object()) return inputs;
    if (const auto size = object.find("wallTexelSize"); size != object.end() && size->is_number())
        inputs.wallTexelSizeMeters = size->get<double>();
    if (!(inputs.wallTexelSizeMeters > 0 && std::isfinite(inputs.wallTexelSizeMeters)))
        inputs.wallTexelSizeMeters = 0;
    inputs.keys = {readKey(object, "all"), readKey(object, "geometry"), readKey(object, "areaIrradiance"),
                   readKey(object, "areaLight")};
    inputs.probes = readKey(object, "probes");
    return inputs;
}

}  // namespace phat
