#pragma once
// Slow stages in parts that a journal keeps.

#include <cstring>

#include "core/bake/gather.h"
#include "core/base/parallel.h"

namespace phat {

/// Keys of the journal's parts begin with these.
enum class GatherStage : uint64_t {
    indirect = 1,
    area = 2,
    areaIrradiance = 3,
    moreAreaIrradiance = 4,
    indirectIrradiance = 5,
    lightProbes = 6,
};

// A record of the journal should outweigh its header and the wait for the disk.
inline constexpr size_t kPartBytes = 32 << 10;

/// Fills `values` by fillOne(index, rays) in parts; parts that the journal has are not computed again. With
/// many paths a part takes seconds: a stop is noticed between texels, and the unfinished part is dropped.
/// `context`: what has the progress, the journal and the rayCount of a GatherContext.
template <typename Value, typename Context, typename FillOne>
void fillParts(std::vector<Value>& values, uint64_t key, const Context& context, const FillOne& fillOne,
               size_t partValues = std::max<size_t>(kPartBytes / sizeof(Value), 1)) {
    static_assert(std::is_trivially_copyable_v<Value>);
    BakeJournal* journal = context.journal;
    parallelRanges(values.size(), partValues, context.progress, [&](size_t begin, size_t end) {
        const size_t byteCount = (end - begin) * sizeof(Value);
        const uint64_t partKey = hashOf(key, begin);
        if (journal) {
            const std::vector<uint8_t> bytes = journal->load(partKey);
            if (bytes.size() == byteCount) {
                std::memcpy(&values[begin], bytes.data(), byteCount);
                return;
            }
        }
        uint64_t rays = 0;
        for (size_t index = begin; index < end; ++index) {
            context.progress.throwIfStopped();
            fillOne(index, rays);
        }
        context.rayCount += rays;
        if (journal) {
            const auto* bytes = reinterpret_cast<const uint8_t*>(&values[begin]);
            journal->store(partKey, {bytes, bytes + byteCount});
        }
    });
}

}  // namespace phat
