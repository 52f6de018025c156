#include "cli/drawn_report.h"

namespace phat {

using nlohmann::json;

json drawnReport(const RenderOptions& options, const View& view, const FrameTimes& times,
                 const ReflectionCost& cost, const std::string& gpu) {
    json seconds;
    for (const NamedPass& pass : kGpuPasses) seconds[pass.name] = times.*pass.seconds;
    seconds["reflections"] = cost.seconds;
    return {{"output", pathFor(view, options.output)},
            {"method", options.method.name},
            {"width", view.width},
            {"height", view.height},
            {"samplesPerPixel", options.samplesPerPixel},
            {"gpu", gpu},
            {"seconds", std::move(seconds)},
            {"reflectionRays", cost.rays}};
}

json readsReport(std::span<const Image> pictures) {
    const auto readsOf = [&](int source) {
        ReadCount all;
        for (const Image& picture : pictures) {
            const ReadCount reads = countReads(picture, source);
            all.mean += reads.mean / double(pictures.size());
            all.most = std::max(all.most, reads.most);
        }
        return json{{"mean", all.mean}, {"max", all.most}};
    };
    return {{"indirect", readsOf(0)}, {"area", readsOf(1)}};
}

}  // namespace phat
