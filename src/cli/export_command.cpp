// phat export: a bake for other programs. Its PHATexels as pictures, like the left half of the paper's figure
// 4; its irradiance as lightmaps.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "cli/commands.h"
#include "cli/lightmap_export.h"
#include "core/atlas/atlas.h"
#include "core/phatexel/phatexture.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_source.h"
#include "io/image/image_file.h"
#include "io/phat/baked_file.h"

namespace phat {
namespace {

void createFolder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw FileError(folder, "cannot be created: " + error.message());
}

struct Exporter {
    const BakedScene& baked;
    std::filesystem::path folder;
    std::vector<Frame> frames;  // by block

    void write(const std::string& name, const Image& image) const {
        const std::string path = (folder / name).string();
        writeExr(path, image);
        fmt::print("{}\n", path);
    }

    void write(const std::string& name, const std::vector<float>& values) const {
        const std::string path = (folder / name).string();
        const glm::uvec2 size = baked.atlas.sizeTexels;
        writeExrChannels(path, int(size.x), int(size.y), {{"Y", values}});
        fmt::print("{}\n", path);
    }

    void writeLayer(const std::string& prefix, const PhatexelLayer& layer) const {
        const glm::uvec2 size = baked.atlas.sizeTexels;
        Image radiance(int(size.x), int(size.y)), direction = radiance;
        std::vector<float> distance(layer.texels.size()), validity(layer.texels.size());
        for (size_t i = 0; i < layer.texels.size(); ++i) {
            const Phatexel phatexel = unpackPhatexel(layer.texels[i], baked.atlas.unitMeters);
            if (!phatexel.valid) continue;
            const glm::uvec2 texel(i % size.x, i / size.x);
            radiance.pixels[i] = phatexel.radiance;
            direction.pixels[i] = frames[baked.atlas.blockAt(texel)].toWorld(phatexel.directionBlock);
            distance[i] = phatexel.distance;
            validity[i] = 1;
        }
        write(prefix + "radiance.exr", radiance);
        write(prefix + "direction.exr", direction);
        write(prefix + "distance.exr", distance);
        write(prefix + "validity.exr", validity);
    }

    void writeIrradiance(const std::string& name, const std::vector<uint32_t>& packed) const {
        if (packed.empty()) return;
        Image irradiance(int(baked.atlas.sizeTexels.x), int(baked.atlas.sizeTexels.y));
        for (size_t i = 0; i < packed.size(); ++i) irradiance.pixels[i] = unpackRgb9e5(packed[i]);
        write(name, irradiance);
    }

    void writeLayers(const std::string& prefix, const std::vector<PhatexelLayer>& layers) const {
        for (size_t i = 0; i < layers.size(); ++i)
            writeLayer(layers.size() == 1 ? prefix : fmt::format("{}layer{}-", prefix, i), layers[i]);
    }
};

void exportPictures(const BakedScene& baked, const std::string& folder) {
    createFolder(folder);
    const Exporter exporter{baked, folder, blockFrames(baked.atlas, baked.points)};
    exporter.writeLayers("", baked.phatexture.indirect);
    exporter.writeLayers("area-", baked.phatexture.area);
    exporter.writeIrradiance("irradiance.exr", baked.phatexture.indirectIrradiance);
    exporter.writeIrradiance("area-irradiance.exr", baked.phatexture.areaIrradiance);
}

struct ExportOptions {
    std::string input;
    std::string pictures;  // folder; empty: none
    LightmapOptions lightmap;
};

void exportBake(const ExportOptions& options) {
    GltfSource source = openGltf(options.input);
    if (!isBakedFile(source))
        throw FileError(options.input, "is not a baked file: it has no PHATexels to export");
    const BakedScene baked = readBakedFile(source);
    if (!options.lightmap.folder.empty()) exportLightmap(options.lightmap, source, baked);
    if (!options.pictures.empty()) exportPictures(baked, options.pictures);
}

}  // namespace

void addExportCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("export", "Write what is in a baked file for other programs");
    const auto options = std::make_shared<ExportOptions>();
    command->add_option("FILE", options->input, "A .phat.glb file")->required();
    command
        ->add_option("--exr", options->pictures, "Folder for PHATexels as OpenEXR pictures; made if missing")
        ->type_name("DIR");
    declareLightmap(*command, options->lightmap);
    command->footer(
        "--exr writes:\n"
        "radiance.exr   W/(m2 sr), arriving\n"
        "direction.exr  toward the light, world space, each axis in [-1,1] as red, green, blue\n"
        "distance.exr   metres to where the light came from; 1e30: infinitely far\n"
        "validity.exr   1 where there is a PHATexel; the others are 0 in all pictures\n"
        "irradiance.exr W/m2, of all light that arrives after a reflection\n"
        "area-*.exr     the same for direct light of emissive surfaces and the environment\n"
        "Several layers are told apart as layer0-, layer1- ... The pictures lie as the atlas UV set does.\n"
        "--lightmap writes a plain .glb with the atlas as its second UV set, irradiance for it as .exr and\n"
        "RGBM .png, and lightmap.json, which says what is what.\n"
        "Examples: phat export room.phat.glb --exr room-phatexels/\n"
        "          phat export room.phat.glb --lightmap room-lightmap/");
    command->callback([command, options] {
        if (command->count("--exr") + command->count("--lightmap") == 0)
            throw CLI::RequiredError("--exr or --lightmap");
        exportBake(*options);
    });
}

}  // namespace phat
