#include "gl/pass_clock.h"

namespace phat {

void PassClock::stamp() {
    if (used_ == stamps_.size()) {
        GLuint name = 0;
        glCreateQueries(GL_TIMESTAMP, 1, &name);
        stamps_.emplace_back(name);
    }
    glQueryCounter(stamps_[used_++].name(), GL_TIMESTAMP);
}

void PassClock::restart() {
    used_ = 0;
    passes_.clear();
    stamp();
}

void PassClock::ended(Pass pass) {
    stamp();
    passes_.push_back(pass);
}

double PassClock::seconds(Pass pass) const {
    double sum = 0;
    for (size_t i = 0; i < passes_.size(); ++i) {
        if (passes_[i] != pass) continue;
        GLuint64 begin = 0, end = 0;
        glGetQueryObjectui64v(stamps_[i].name(), GL_QUERY_RESULT, &begin);
        glGetQueryObjectui64v(stamps_[i + 1].name(), GL_QUERY_RESULT, &end);
        if (end > begin) sum += double(end - begin) * 1e-9;
    }
    return sum;
}

}  // namespace phat
