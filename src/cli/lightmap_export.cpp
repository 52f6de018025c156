#include "cli/lightmap_export.h"

#include <fmt/format.h>

#include <filesystem>

#include "cli/interrupt.h"
#include "cli/owned_folder.h"
#include "cli/progress_bar.h"
#include "io/base/file_error.h"
#include "io/base/printable.h"

namespace phat {
namespace {

constexpr uint32_t kMinPageSize = 16, kMaxPageSize = 1 << 16;

// The file's name up to its first point.
std::string stemOf(const std::string& path) {
    const std::string name = std::filesystem::path(path).filename().string();
    return name.substr(0, name.find('.'));
}

void reportFiles(const LightmapOptions& options, const std::vector<LightmapFile>& files,
                 const std::vector<std::string>& notes) {
    for (const std::string& note : notes) fmt::print("note: {}\n", printable(note));
    for (const LightmapFile& file : files)
        fmt::print("{}/{}: {} bytes\n", options.folder, file.name, file.bytes.size());
}

}  // namespace

void declareLightmap(CLI::App& command, LightmapOptions& options) {
    CLI::Option* lightmap =
        command
            .add_option(
                "--lightmap", options.folder,
                "Folder for a plain .glb with lightmaps: a new or empty one, or that of an older lightmap")
            ->type_name("DIR");
    std::vector<std::string> names;
    for (const auto& [name, light] : lightmapLightNames()) names.push_back(name);
    command
        .add_option_function<std::string>(
            "--light", [&options](const std::string& name) { options.light = lightmapLightNames().at(name); },
            "--lightmap: indirect; area: also straight from emissive surfaces and the environment; all: also "
            "from punctual lights, which the .glb then lacks")
        ->type_name("NAME")
        ->check(CLI::IsMember(names))
        ->default_str("area")
        ->needs(lightmap);
    command
        .add_option("--page-size", options.pageSize,
                    "--lightmap: texels of a texture's side, at most; a larger atlas becomes several")
        ->type_name("N")
        ->check(CLI::Range(kMinPageSize, kMaxPageSize))
        ->capture_default_str()
        ->needs(lightmap);
    command
        .add_flag("--directional", options.directional,
                  "--lightmap: also where the light comes from, for normal maps")
        ->needs(lightmap);
    command
        .add_flag("--front-only", options.frontOnly,
                  "--lightmap: double-sided surfaces stay so, with their front's light on both sides; for "
                  "programs that do not cull backs")
        ->needs(lightmap);
    command.add_flag("--quiet", options.quiet, "Say nothing")->needs(lightmap);
}

void exportLightmap(const LightmapOptions& options, const GltfSource& source, const BakedScene& baked) {
    const std::string stem = stemOf(source.path);
    std::vector<LightmapFile> files;
    std::vector<std::string> notes;
    try {
        const AtlasPages pages = pagesOf(baked.atlas, options.pageSize);
        const PartSides sides = options.frontOnly ? PartSides::front : PartSides::both;
        const LightmapExport what{source, baked, pages, stem, options.light, options.directional, sides};
        const std::vector<std::string> names = lightmapFileNames(what);
        OwnedFolder folder(kLightmapFolder, options.folder, source.path, {names.begin(), names.end()});
        catchInterrupts();
        ProgressBar progress(progressStyle(options.quiet), {});
        files = lightmapFiles(what, progress, notes);
        std::vector<OutputFile> output;
        for (const LightmapFile& file : files) output.push_back({file.name, file.bytes});
        folder.write(output);
    } catch (const FileError&) {
        throw;
    } catch (const Interrupted&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw FileError(source.path, error.what());
    }
    if (!options.quiet) reportFiles(options, files, notes);
}

}  // namespace phat
