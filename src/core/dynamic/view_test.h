#pragma once
// Whether a camera may see a part of a surface; never says no of what it sees, but for what hides it.

#include "core/scene/scene.h"

namespace phat {

class ViewTest {
  public:
    explicit ViewTest(const Camera& camera);
    /// Of what lies within `radius` of `center` and faces about where `normal` does. pre: |normal| = 1.
    bool maySee(glm::vec3 center, glm::vec3 normal, float radius) const;

  private:
    glm::mat4 cameraFromWorld_;
    glm::vec3 eye_;
    bool perspective_;
    float halfHeight_, aspect_;  // of the picture; perspective: at a distance of 1
};

}  // namespace phat
