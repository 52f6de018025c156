// The fuzzer's corpus, which holds what it has found, through the targets that it runs.

#include <gtest/gtest.h>

#include "fuzz/targets.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

struct Target {
    const char* name;
    void (*run)(fuzz::Bytes);
};

class FuzzCorpus : public testing::TestWithParam<Target> {};

TEST_P(FuzzCorpus, KeepsItsPromises) {
    const auto folder = std::filesystem::path(PHAT_SOURCE_DIR) / "fuzz/corpus" / GetParam().name;
    size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::vector<char> bytes = readBytes(entry.path());
        EXPECT_NO_THROW(GetParam().run({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()}))
            << entry.path();
        ++files;
    }
    EXPECT_GT(files, 1u);
}

INSTANTIATE_TEST_SUITE_P(AllTargets, FuzzCorpus,
                         testing::Values(Target{"gltf", fuzz::gltf}, Target{"baked", fuzz::baked},
                                         Target{"picture", fuzz::picture}, Target{"journal", fuzz::journal},
                                         Target{"ies", fuzz::ies}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace phat
