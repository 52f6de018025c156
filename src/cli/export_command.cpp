// phat export: the PHATexels as pictures, like the left half of the paper's figure 4.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "cli/commands.h"
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

void exportPictures(const std::string& path, const std::string& folder) {
    GltfSource source = openGltf(path);
    if (!isBakedFile(source)) throw FileError(path, "is not a baked file: it has no PHATexels to export");
    const BakedScene baked = readBakedFile(source);
    createFolder(folder);
    const Exporter exporter{baked, folder, blockFrames(baked.atlas, baked.points)};
    exporter.writeLayers("", baked.phatexture.indirect);
    exporter.writeLayers("area-", baked.phatexture.area);
    exporter.writeIrradiance("irradiance.exr", baked.phatexture.indirectIrradiance);
    exporter.writeIrradiance("area-irradiance.exr", baked.phatexture.areaIrradiance);
}

}  // namespace

void addExportCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("export", "Write the PHATexels of a baked file as pictures");
    CLI::Option* file = command->add_option("FILE", "A .phat.glb file")->required();
    CLI::Option* folder = command->add_option("--exr", "Folder for the OpenEXR pictures; made if missing")
                              ->type_name("DIR")
                              ->required();
    command->footer(
        "radiance.exr   W/(m2 sr), arriving\n"
        "direction.exr  toward the light, world space, each axis in [-1,1] as red, green, blue\n"
        "distance.exr   metres to where the light came from; 1e30: infinitely far\n"
        "validity.exr   1 where there is a PHATexel; the others are 0 in all pictures\n"
        "irradiance.exr W/m2, of all light that arrives after a reflection\n"
        "area-*.exr     the same for direct light of emissive surfaces and the environment\n"
        "Several layers are told apart as layer0-, layer1- ... The pictures lie as the atlas UV set does.\n"
        "Example: phat export room.phat.glb --exr room-phatexels/");
    command->callback([=] { exportPictures(file->as<std::string>(), folder->as<std::string>()); });
}

}  // namespace phat
