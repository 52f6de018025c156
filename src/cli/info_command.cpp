// phat info: what is in a scene or a baked file.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/size_note.h"
#include "core/atlas/atlas_stats.h"
#include "core/atlas/texel_size.h"
#include "core/scene/default_camera.h"
#include "core/scene/scene.h"
#include "core/scene/transparency.h"
#include "io/base/printable.h"
#include "io/gltf/blender_units.h"
#include "io/gltf/gltf_source.h"
#include "io/gltf/gltf_variants.h"
#include "io/phat/bake_record.h"
#include "io/phat/baked_file.h"
#include "io/phat/scene_lighting.h"

namespace phat {
namespace {

using Json = nlohmann::ordered_json;

Json vectorJson(glm::vec3 v) {
    return {v.x, v.y, v.z};
}

Json namesOf(const auto& things) {
    Json names = Json::array();
    for (const auto& thing : things) names.push_back(thing.name);
    return names;
}

Json describeDefaultView(const Scene& scene) {
    const DefaultView view = defaultView(RayScene(scene), LightSampler(scene));
    return {{"eye", vectorJson(glm::vec3(view.camera.worldFromCamera[3]))},
            {"target", vectorJson(view.target)},
            {"yfovDegrees", glm::degrees(view.camera.yfovRadians)},
            {"where", view.inside ? "inside" : "outside"}};
}

Json describePhotometry(const PunctualLight& light) {
    constexpr float kBeam = 0.5f, kField = 0.1f;
    const Photometry& photometry = *light.photometry;
    const float multiplier = luminance(light.intensity) / photometry.web().peakCandela;
    const auto spread = [&](float fraction) -> Json {
        return {photometry.spreadDegrees(0, fraction), photometry.spreadDegrees(90, fraction)};
    };
    return {{"name", photometry.web().name},
            {"lumens", multiplier * photometry.lumens()},
            {"peakCandela", multiplier * photometry.web().peakCandela},
            {"beamDegrees", spread(kBeam)},
            {"fieldDegrees", spread(kField)}};
}

// `lit`: with the light that is added for want of any, which the default view depends on.
Json describeScene(const LoadedScene& loaded, const Scene& lit) {
    constexpr const char* kLightTypes[] = {"point", "spot", "directional"};
    const Scene& scene = loaded.scene;
    Json lights = Json::array();
    for (const PunctualLight& light : scene.lights) {
        lights.push_back({{"name", light.name}, {"type", kLightTypes[size_t(light.type)]}});
        if (light.angularRadius > 0)
            lights.back()["angularDiameterDegrees"] = 2 * glm::degrees(light.angularRadius);
        if (light.photometry) lights.back()["photometry"] = describePhotometry(light);
    }
    size_t emissive = 0, transmissive = 0;
    for (const Material& material : scene.materials) {
        emissive += maxComponent(material.emission) > 0;
        transmissive += isGlass(material);
    }

    Json report{{"triangles", scene.triangles.size()},
                {"vertices", scene.positions.size()},
                {"surfaces", scene.surfaces.size()},
                {"materials", namesOf(scene.materials)},
                {"emissiveMaterials", emissive},
                {"transmissiveMaterials", transmissive},
                {"textures", scene.images.size()},
                {"lights", lights},
                {"cameras", namesOf(scene.cameras)},
                {"environment", nullptr},
                {"bounds", nullptr},
                {"notes", loaded.notes}};
    if (scene.environment)
        report["environment"] = {scene.environment->radiance.width, scene.environment->radiance.height};
    if (const Bounds bounds = boundsOf(scene); !bounds.empty())
        report["bounds"] = {{"low", vectorJson(bounds.low)}, {"high", vectorJson(bounds.high)}};
    if (const std::optional<std::string> note = sizeNote(scene)) report["notes"].push_back(*note);
    report["defaultCamera"] = nullptr;
    if (scene.cameras.empty() && !scene.triangles.empty()) report["defaultCamera"] = describeDefaultView(lit);
    return report;
}

Json describeLayers(const std::vector<PhatexelLayer>& layers) {
    uint64_t all = 0, valid = 0, bytes = 0;
    for (const PhatexelLayer& layer : layers) {
        all += layer.texels.size();
        for (const PackedPhatexel& texel : layer.texels) valid += texel.directionDistance != 0;
        bytes += layer.texels.size() * sizeof(PackedPhatexel) + layer.pdf.size() * sizeof(float);
    }
    return {{"layers", layers.size()},
            {"phatexels", all},
            {"valid", valid},
            {"validFraction", all ? double(valid) / double(all) : 0.0},
            {"bytes", bytes}};
}

Json describeBake(const BakedScene& baked) {
    const Atlas& atlas = baked.atlas;
    const Phatexture& phatexture = baked.phatexture;
    const auto notOccluded =
        std::count(baked.points.state.begin(), baked.points.state.end(), TexelState::surface);
    const size_t guides = phatexture.indirectGuides.size() + phatexture.areaGuides.size();

    return {{"record",
             {{"generator", baked.record.generator},
              {"source", baked.record.source},
              {"seed", baked.record.seed},
              {"settings", settingsJson(baked.record.settings)}}},
            {"atlas",
             {{"size", {atlas.sizeTexels.x, atlas.sizeTexels.y}},
              {"texelSizeMeters", atlas.texelSizeMeters},
              {"medianTexelSizeMeters", medianTexelSizeMeters(atlas)},
              {"finestTexelSizeMeters", atlas.finestTexelSizeMeters()},
              {"unitMeters", atlas.unitMeters},
              {"charts", atlas.charts.size()},
              {"blocks", atlas.blockCount},
              {"coverage", coverageOf(atlas)},
              {"notOccluded", double(notOccluded) / double(std::max<size_t>(1, atlas.texelCount()))}}},
            {"dynamic", settingsOf(baked.record).dynamic},
            {"storage", nameOf(storageNames(), baked.record.storage)},
            {"indirect", describeLayers(phatexture.indirect)},
            {"area", describeLayers(phatexture.area)},
            {"guideBytes", guides * sizeof(Guide)},
            {"irradianceBytes",
             (phatexture.indirectIrradiance.size() + phatexture.areaIrradiance.size()) * sizeof(uint32_t)},
            {"probes",
             {{"count", baked.probes.count()},
              {"grid", {baked.probes.gridSize.x, baked.probes.gridSize.y, baked.probes.gridSize.z}},
              {"cells", baked.probes.cells.size()},
              {"bytes", probeBytes(baked.probes)}}}};
}

Json describe(const std::string& path) {
    GltfSource source = openGltf(path);  // throws where the size below would say nothing
    Json report{{"file", path}, {"fileBytes", std::filesystem::file_size(path)}};
    if (isBakedFile(source)) {
        const BakedScene baked = readBakedFile(source);
        report["scene"] = describeScene(baked.loaded, baked.loaded.scene);
        report["bake"] = describeBake(baked);
    } else {
        const LoadedScene loaded = loadGltf(source);
        Scene lit = loaded.scene;  // as the other commands do
        const AddedLighting added = addLighting({}, lit);
        report["scene"] = describeScene(loaded, lit);
        for (const std::string& line : added.lines) report["scene"]["notes"].push_back(line);
        if (const auto units = blenderUnitsNote(source, loaded.scene))
            report["scene"]["notes"].push_back(*units);
    }
    report["scene"]["variants"] = gltfVariants(source);
    return report;
}

std::string megabytes(const Json& bytes) {
    return fmt::format("{:.2f} MB", double(bytes.get<uint64_t>()) * 1e-6);
}

void printLine(const char* label, const std::string& text) {
    fmt::print("  {:<12} {}\n", label, printable(text));
}

std::string joined(const Json& names) {
    std::string text;
    for (const auto& name : names) text += (text.empty() ? "" : ", ") + name.get<std::string>();
    return text.empty() ? "none" : text;
}

std::string anglesOf(const Json& spread) {
    const float along = spread[0].get<float>(), across = spread[1].get<float>();
    return std::abs(along - across) < 0.5f ? fmt::format("{:.0f}", along)
                                           : fmt::format("{:.0f} x {:.0f}", along, across);
}

void printPhotometry(const std::string& light, const Json& photometry) {
    printLine("photometry",
              fmt::format("{}: {}, {:.4g} lm, peak {:.4g} cd, beam {} and field {} degrees", light,
                          photometry["name"].get<std::string>(), photometry["lumens"].get<float>(),
                          photometry["peakCandela"].get<float>(), anglesOf(photometry["beamDegrees"]),
                          anglesOf(photometry["fieldDegrees"])));
}

void printScene(const Json& scene) {
    printLine("triangles", fmt::format("{} in {} surfaces", scene["triangles"].get<size_t>(),
                                       scene["surfaces"].get<size_t>()));
    printLine("materials",
              fmt::format("{} ({} emissive, {} transmissive), {} textures", scene["materials"].size(),
                          scene["emissiveMaterials"].get<size_t>(),
                          scene["transmissiveMaterials"].get<size_t>(), scene["textures"].get<size_t>()));
    std::string lights;
    for (const auto& light : scene["lights"])
        lights += fmt::format("{}{} ({})", lights.empty() ? "" : ", ", light["name"].get<std::string>(),
                              light["type"].get<std::string>());
    printLine("lights", lights.empty() ? "none" : lights);
    for (const auto& light : scene["lights"])
        if (light.contains("photometry"))
            printPhotometry(light["name"].get<std::string>(), light["photometry"]);
    printLine("cameras", joined(scene["cameras"]));
    if (!scene["variants"].empty()) printLine("variants", joined(scene["variants"]));
    if (const Json& view = scene["defaultCamera"]; !view.is_null()) {
        const auto eye = view["eye"].get<std::array<float, 3>>(),
                   target = view["target"].get<std::array<float, 3>>();
        printLine("default view", fmt::format("{}, from ({:.4g} {:.4g} {:.4g}) to ({:.4g} {:.4g} {:.4g})",
                                              view["where"].get<std::string>(), eye[0], eye[1], eye[2],
                                              target[0], target[1], target[2]));
    }
    if (const Json& size = scene["environment"]; !size.is_null())
        printLine("environment", fmt::format("{} x {}", size[0].get<int>(), size[1].get<int>()));
    if (const Json& bounds = scene["bounds"]; !bounds.is_null()) {
        const auto low = bounds["low"].get<std::array<float, 3>>(),
                   high = bounds["high"].get<std::array<float, 3>>();
        printLine("bounds", fmt::format("({:.4g} {:.4g} {:.4g}) to ({:.4g} {:.4g} {:.4g}) m", low[0], low[1],
                                        low[2], high[0], high[1], high[2]));
    }
    for (const auto& note : scene["notes"]) printLine("note", note.get<std::string>());
}

void printLayers(const char* label, const Json& part) {
    const size_t layers = part["layers"].get<size_t>();
    printLine(label, fmt::format("{} PHATexels in {} {}, {:.1f} % valid, {}",
                                 part["phatexels"].get<uint64_t>(), layers, layers == 1 ? "layer" : "layers",
                                 100 * part["validFraction"].get<double>(), megabytes(part["bytes"])));
}

void printBake(const Json& bake) {
    const Json& atlas = bake["atlas"];
    const double coarsest = 1000 * atlas["texelSizeMeters"].get<double>(),
                 median = 1000 * atlas["medianTexelSizeMeters"].get<double>(),
                 finest = 1000 * atlas["finestTexelSizeMeters"].get<double>();
    const std::string range =
        finest < coarsest ? fmt::format(" ({:.3g} to {:.3g} mm)", finest, coarsest) : "";
    printLine(
        "atlas",
        fmt::format("{} x {} texels of {:.3g} mm{}, {} charts, coverage {:.1f} % ({:.1f} % not occluded)",
                    atlas["size"][0].get<uint32_t>(), atlas["size"][1].get<uint32_t>(), median, range,
                    atlas["charts"].get<size_t>(), 100 * atlas["coverage"].get<double>(),
                    100 * atlas["notOccluded"].get<double>()));
    if (bake["dynamic"].get<bool>())
        printLine("dynamic", "texels also for what is dark, and for lamps that are off: it can light up");
    printLine("storage", bake["storage"] == "paper"
                             ? "paper: 16 bytes a PHATexel, no distances (in memory 8 bytes, infinitely far)"
                             : "packed: 8 bytes a PHATexel");
    printLayers("indirect", bake["indirect"]);
    if (bake["area"]["layers"] != 0) printLayers("area lights", bake["area"]);
    printLine("guides", megabytes(bake["guideBytes"]));
    if (bake["irradianceBytes"] != 0) printLine("irradiance", megabytes(bake["irradianceBytes"]));
    if (const Json& probes = bake["probes"]; probes["count"] != 0)
        printLine("probes", fmt::format("{} in {} cells, {}", probes["count"].get<size_t>(),
                                        probes["cells"].get<size_t>(), megabytes(probes["bytes"])));
    const Json& record = bake["record"];
    printLine("baked by", fmt::format("{} from {}, seed {}", record["generator"].get<std::string>(),
                                      record["source"].get<std::string>(), record["seed"].get<uint64_t>()));
    printLine("settings", record["settings"].dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

void addInfoCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("info", "Say what is in a scene or a baked file");
    CLI::Option* file = command->add_option("FILE", "A .glb or .gltf file, baked or not")->required();
    CLI::Option* asJson = command->add_flag("--json")->description("Print JSON");
    command->footer(
        "Sizes of payloads are in memory; the file holds them compressed.\n"
        "Example: phat info room.phat.glb --json");
    command->callback([=] {
        const Json report = describe(file->as<std::string>());
        if (asJson->count() > 0) {
            fmt::print("{}\n", report.dump(2, ' ', false, Json::error_handler_t::replace));
            return;
        }
        fmt::print("{} ({})\n", report["file"].get<std::string>(), megabytes(report["fileBytes"]));
        printScene(report["scene"]);
        if (report.contains("bake")) printBake(report["bake"]);
    });
}

}  // namespace phat
