#include "gl/alias_table.h"

namespace phat {

// source: Vose 1991, "A Linear Algorithm for Generating Random Numbers with a Given Distribution".
AliasTable aliasTable(const std::vector<double>& probabilities) {
    const size_t count = probabilities.size();
    AliasTable table{std::vector<float>(count, 1.0f), std::vector<uint32_t>(count)};
    std::vector<double> scaled(count);
    std::vector<uint32_t> small, large;
    for (uint32_t i = 0; i < count; ++i) {
        table.alias[i] = i;
        scaled[i] = probabilities[i] * double(count);
        (scaled[i] < 1 ? small : large).push_back(i);
    }
    while (!small.empty() && !large.empty()) {
        const uint32_t low = small.back(), high = large.back();
        small.pop_back();
        table.threshold[low] = float(scaled[low]);
        table.alias[low] = high;
        scaled[high] -= 1 - scaled[low];
        if (scaled[high] < 1) {
            large.pop_back();
            small.push_back(high);
        }
    }
    return table;
}

}  // namespace phat
