#include "core/scene/length_unit.h"

#include "core/scene/enclosure.h"

namespace phat {

float lengthUnit(const Scene& scene) {
    const float diagonal = boundsWithoutGround(scene).diagonal();
    return diagonal > 0 ? diagonal / 8 : 1.0f;
}

}  // namespace phat
