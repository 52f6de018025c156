// Baked files of all format versions, as they were written once (tests/data/versions).

#include <gtest/gtest.h>

#include "io/phat/bake_journal.h"
#include "io/phat/bake_record.h"
#include "io/phat/baked_file.h"
#include "io/phat/phat_payload.h"

namespace phat {
namespace {

struct Version {
    const char* file;
    glm::uvec2 sizeTexels;
    size_t charts, probes;
    PhatexelStorage storage;
    uint64_t light;  // fingerprint of all PHATexels and irradiance
};

uint64_t lightOf(const Phatexture& phatexture) {
    Fingerprint all;
    for (const auto* layers : {&phatexture.indirect, &phatexture.area})
        for (const PhatexelLayer& layer : *layers) all.add(bytesOf(layer.texels));
    for (const auto* guides : {&phatexture.indirectGuides, &phatexture.areaGuides}) all.add(bytesOf(*guides));
    for (const auto* map : {&phatexture.indirectIrradiance, &phatexture.areaIrradiance})
        all.add(bytesOf(*map));
    return all.value();
}

TEST(FormatVersions, AreReadAsTheyWereWritten) {
    const Version versions[] = {
        {"version-3.phat.glb", {24, 16}, 6, 0, PhatexelStorage::packed, 8309644157901493758u},
        {"version-4.phat.glb", {24, 16}, 6, 0, PhatexelStorage::paper, 13574020117594684453u},
        {"version-5.phat.glb", {56, 40}, 30, 8, PhatexelStorage::packed, 2621138894003920398u},
    };
    for (const Version& version : versions) {
        SCOPED_TRACE(version.file);
        const BakedScene baked =
            readBakedFile(std::string(PHAT_SOURCE_DIR) + "/tests/data/versions/" + version.file);
        EXPECT_EQ(baked.atlas.sizeTexels, version.sizeTexels)
            << baked.atlas.sizeTexels.x << " x " << baked.atlas.sizeTexels.y;
        EXPECT_EQ(baked.atlas.charts.size(), version.charts);
        EXPECT_EQ(baked.probes.count(), version.probes);
        EXPECT_EQ(baked.record.storage, version.storage);
        EXPECT_EQ(lightOf(baked.phatexture), version.light);
    }
}

}  // namespace
}  // namespace phat
