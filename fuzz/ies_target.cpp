#include <cmath>
#include <stdexcept>

#include "core/base/math.h"
#include "expect.h"
#include "io/ies/ies_photometry.h"
#include "targets.h"

namespace phat::fuzz {

void ies(Bytes bytes) {
    try {
        const Photometry photometry = photometryOfIes(bytes, "fuzz");
        const PhotometricWeb& web = photometry.web();
        expect(web.relative.size() == size_t(web.horizontalSteps) * (web.verticalSteps + 1), "a whole web");
        expect(std::isfinite(photometry.lumens()) && photometry.lumens() > 0, "a flux");
        for (const float value : web.relative) expect(value >= 0 && value <= 1, "relative intensities");
        for (const float x : {0.0f, 0.4f, 1 - 0x1p-24f})
            for (const float y : {0.0f, 0.7f, 1 - 0x1p-24f})
                expect(isUnit(photometry.sample({x, y})), "a direction");
    } catch (const std::runtime_error&) {
    }
}

}  // namespace phat::fuzz
