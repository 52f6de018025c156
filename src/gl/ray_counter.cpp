#include "gl/ray_counter.h"

namespace phat {

void RayCounter::begin() {
    if (used_ == queries_.size()) {
        GLuint name = 0;
        glCreateQueries(GL_SAMPLES_PASSED, 1, &name);
        queries_.emplace_back(name);
    }
    glBeginQuery(GL_SAMPLES_PASSED, queries_[used_++].name());
}

void RayCounter::end() {
    glEndQuery(GL_SAMPLES_PASSED);
}

uint64_t RayCounter::rays() const {
    uint64_t sum = 0;
    for (size_t i = 0; i < used_; ++i) {
        GLuint64 passed = 0;
        glGetQueryObjectui64v(queries_[i].name(), GL_QUERY_RESULT, &passed);
        sum += passed;
    }
    return sum;
}

}  // namespace phat
