#pragma once
// The camera as the rasteriser has it.

#include "core/scene/scene.h"
#include "gl/gl_objects.h"
#include "gl/relight_pass.h"

namespace phat {

struct CameraMatrices {
    glm::mat4 clipFromWorld{1};          // for ReversedDepth
    glm::mat4 worldFromClipRotation{1};  // with the eye at the origin, depth from -1 to 1
};

/// The picture's shape, not the camera's: a view of another shape shows more or less to the sides,
/// undistorted. `jitter` in pixels.
CameraMatrices matricesOf(const Camera& camera, glm::uvec2 size, const Bounds& bounds, glm::vec2 jitter);

/// While it lives, clip space has depths from 0 at the far plane to 1 at the near plane. Floats are dense
/// near 0, and so surfaces are told apart by a fraction of their distance anywhere; the other way round, with
/// a near plane of .01 m, those 1 km away are by 6 m. source: Reed 2015, "Depth Precision Visualized".
struct ReversedDepth {
    ReversedDepth() { glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE); }
    ~ReversedDepth() { glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE); }
    ReversedDepth(const ReversedDepth&) = delete;
    ReversedDepth& operator=(const ReversedDepth&) = delete;
};

/// Where in the pixel sample `index` of `count` lies, from -.5 to .5. twin: jitterOf in
/// web/src/sample_numbers.js.
glm::vec2 jitterOf(int index, int count);
/// The eye of a camera.
Eye eyeOf(const Camera& camera);

}  // namespace phat
