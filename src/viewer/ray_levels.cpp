#include "viewer/ray_levels.h"

namespace phat {

int nextRayLevel(int level, double seconds, double budget) {
    if (seconds > budget && level + 1 < int(kRayLevels.size())) return level + 1;
    if (seconds < 0.5 * budget && level > 0) return level - 1;
    return level;
}

}  // namespace phat
