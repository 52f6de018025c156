#pragma once
// The pictures left and right of the wipe, refined by a sample a frame while nothing changes.

#include <chrono>
#include <future>
#include <memory>
#include <optional>

#include "core/render/metrics.h"
#include "gl/picture_sum.h"
#include "gl/present_pass.h"
#include "viewer/path_preview.h"
#include "viewer/ray_levels.h"
#include "viewer/viewer_state.h"

namespace phat {

class Pictures {
  public:
    Pictures(const std::string& shaderFolder, Wake wake);

    /// Another document: nothing of the last one is shown.
    void reset();
    /// The document's bake is another one.
    void takeNewBake() { reflections_.reset(); }
    /// Brings the pictures of `size` pixels nearer to what the state asks for. Returns whether more can be
    /// done at once; what the path tracer still has to do wakes the window by itself.
    bool refine(ViewerState& state, glm::uvec2 size, std::chrono::steady_clock::time_point now);
    /// Draws them into `area` (x, y from the top left, width, height) of a window so many pixels high.
    void show(const ViewerState& state, glm::ivec4 area, int windowHeight);

    struct SideReport {
        int samples = 0, wanted = 0;
    };
    SideReport left() const { return reportOf(sides_[0]); }
    SideReport right() const { return reportOf(sides_[1]); }
    /// How far the left picture is from the right one; once both are there.
    std::optional<Metrics> metrics() const { return metrics_; }
    /// Seconds of the last drawn frame by pass, and how many times fewer pixels a side it had.
    FrameTimes frameTimes() const { return frameTimes_; }
    double reflectionSeconds() const { return reflectionSeconds_; }  // of its rays on the CPU
    int coarseness() const { return coarseness_; }
    /// Of the last picture of Inspected::reads.
    struct Reads {
        ReadCount indirect, area;
    };
    std::optional<Reads> reads() const { return reads_; }
    /// Smooth surfaces of the left picture are looked up, because rays would take too long.
    bool tooManyRays() const { return sides_[0].tooManyRays; }

  private:
    struct Side {
        Source source = Source::phat;
        uint64_t version = ~0ull;  // of the state, that the picture shows
        uint64_t lightVersion = 0;
        PictureSum drawn;
        PictureSum next;  // by newer light: replaces `drawn` when it has some samples
        uint64_t nextLightVersion = 0;
        uint32_t refinements = 0;  // of the light when `drawn` was begun
        Image traced;              // what tracedTexture shows
        GlTexture tracedTexture;
        int tracedSamples = 0;
        int wanted = 0;
        bool byRays = false;       // the drawn samples' smooth reflections
        bool tooManyRays = false;  // for this version
        bool light = true;         // what is drawn, see Presented
        bool counts = false;
    };
    static SideReport reportOf(const Side& side);
    static Reads readsOf(const Image& picture);
    void draw(ViewerState& state, Side& side, PictureSum& sum, glm::uvec2 size, int samplesPerPixel,
              bool rays);
    void traceOnGpu(const ViewerState& state, const Side& side, bool atRest, FrameSettings& settings);
    void followLight(ViewerState& state, Side& side, bool rays);
    bool showsReflections(const ViewerState& state, const Side& side) const;
    bool mayTrace(const ViewerState& state, const Side& side) const;
    const TracedReflections& reflections(const ViewerState& state, double seconds);
    void askPathTracer(const ViewerState& state, Side& side, glm::uvec2 size);
    void takePathTracer(Side& side);
    void measure(const ViewerState& state);
    int coarsenessFor(glm::uvec2 size) const;

    PresentPass present_;
    Wake wake_;
    std::array<Side, 2> sides_;
    std::unique_ptr<PathPreview> path_;
    glm::uvec2 size_{0};
    uint64_t version_ = 0;
    std::chrono::steady_clock::time_point lastChange_{};
    double secondsPerPixel_ = 0;
    FrameTimes frameTimes_;
    double reflectionSeconds_ = 0;
    int coarseness_ = 1;
    int rayLevel_ = kFirstRayLevel;  // of the GPU's rays while something moves
    uint32_t movingFrames_ = 0;
    std::optional<LiveReflections> reflections_;
    uint64_t reflectionsVersion_ = 0;  // Document::rayVersion
    std::optional<Reads> reads_;
    std::optional<Metrics> metrics_;
    std::future<Metrics> measuring_;
    uint64_t measuringVersion_ = 0;  // of the state whose pictures are being measured
    int measuredSamples_ = 0;
};

}  // namespace phat
