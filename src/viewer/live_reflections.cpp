#include "viewer/live_reflections.h"

namespace phat {

LiveReflections::LiveReflections(const Document& document)
    : shown_(document.posed.snapshot()),
      lights_(shown_->scene()),
      scene_(shown_->rays(), lights_, document.baked.atlas, document.baked.points, document.baked.phatexture),
      traced_{scene_, Reflections::automatic, limit_} {}

const TracedReflections& LiveReflections::within(double seconds) {
    limit_.seconds = seconds;
    return traced_;
}

bool LiveReflections::Limit::stopRequested() const {
    return seconds > 0 && start_.seconds() > seconds;
}

}  // namespace phat
