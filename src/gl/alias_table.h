#pragma once
// Choice in proportion to given chances, by one random number and one entry of a table.

#include <cstdint>
#include <vector>

namespace phat {

/// Walker's alias method: with column `i` chosen uniformly, i by threshold[i], else alias[i].
struct AliasTable {
    std::vector<float> threshold;
    std::vector<uint32_t> alias;
};

/// twin: aliasTable in web/src/alias_table.js.
AliasTable aliasTable(const std::vector<double>& probabilities);

}  // namespace phat
