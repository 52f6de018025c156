// phat compare: how far one picture is from another, as figures and as a picture.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "cli/commands.h"
#include "core/render/metrics.h"
#include "io/base/file_error.h"
#include "io/image/image_file.h"

namespace phat {
namespace {

enum class Map { flip, signedError };

struct CompareOptions {
    std::string test;
    std::string reference;
    std::string mask;      // empty: none
    std::string variance;  // of the reference; empty: not known
    std::string out;       // empty: none
    Map map = Map::flip;
    float exposureStops = 0;
    bool json = false;
};

Image readFinite(const std::string& path) {
    Image image = readPicture(path);
    if (const uint64_t bad = countNonFinite(image))
        throw FileError(
            path, fmt::format("{} of {} pixels are infinite or not a number", bad, image.pixels.size()));
    return image;
}

void requireSize(const std::string& path, const Image& image, const std::string& otherPath,
                 const Image& other) {
    if (image.width != other.width || image.height != other.height)
        throw FileError(path, fmt::format("is {} x {} pixels, but {} is {} x {}", image.width, image.height,
                                          otherPath, other.width, other.height));
}

glm::vec3 interpolate(std::span<const glm::vec3> colors, float t) {
    const float position = std::clamp(t, 0.0f, 1.0f) * float(colors.size() - 1);
    const size_t i = std::min(size_t(position), colors.size() - 2);
    return glm::mix(colors[i], colors[i + 1], position - float(i));
}

// Colours are given as a screen shows them; writePng encodes linear light.
glm::vec3 linearOf(glm::vec3 encoded) {
    return glm::pow(encoded, glm::vec3(2.2f));
}

// Black through purple and orange to pale yellow: seven stops of matplotlib's "magma" (van der Walt and
// Smith), whose lightness grows evenly, as the FLIP paper shows its maps.
glm::vec3 flipColor(float error) {
    constexpr std::array<glm::vec3, 7> kMagma{{{0.001f, 0.000f, 0.014f},
                                               {0.166f, 0.065f, 0.329f},
                                               {0.390f, 0.100f, 0.502f},
                                               {0.631f, 0.190f, 0.498f},
                                               {0.868f, 0.288f, 0.409f},
                                               {0.987f, 0.536f, 0.382f},
                                               {0.987f, 0.991f, 0.750f}}};
    return linearOf(interpolate(kMagma, error));
}

// Blue where the test is too dark, red where it is too bright, white where it is right.
glm::vec3 signedColor(float error) {
    constexpr std::array<glm::vec3, 5> kBlueToRed{{{0.02f, 0.19f, 0.60f},
                                                   {0.35f, 0.60f, 0.90f},
                                                   {1.00f, 1.00f, 1.00f},
                                                   {0.95f, 0.50f, 0.35f},
                                                   {0.60f, 0.02f, 0.10f}}};
    return linearOf(interpolate(kBlueToRed, 0.5f + 0.5f * error));
}

// (a - b) / (|b| + a tenth of the mean), of luminance; the end colours stand for half and more.
Image signedPicture(const Image& test, const Image& reference) {
    constexpr float kFullScale = 0.5f;
    double sum = 0;
    for (const glm::vec3& pixel : reference.pixels) sum += std::abs(luminance(pixel));
    const float floor = std::max(0.1f * float(sum / double(reference.pixels.size())), 1e-30f);
    Image picture(reference.width, reference.height);
    for (size_t i = 0; i < picture.pixels.size(); ++i) {
        const float b = luminance(reference.pixels[i]);
        const float relative = (luminance(test.pixels[i]) - b) / (std::abs(b) + floor);
        picture.pixels[i] = signedColor(std::clamp(relative / kFullScale, -1.0f, 1.0f));
    }
    return picture;
}

Image flipPicture(const Image& test, const Image& reference) {
    const std::vector<float> errors = flipMap(test, reference);
    Image picture(reference.width, reference.height);
    for (size_t i = 0; i < errors.size(); ++i) picture.pixels[i] = flipColor(errors[i]);
    return picture;
}

// Dark grey, a colour of neither map.
void dimOutside(Image& picture, const Image& mask) {
    for (size_t i = 0; i < picture.pixels.size(); ++i)
        if (!(mask.pixels[i].x > 0.5f)) picture.pixels[i] = glm::vec3(0.1f * luminance(picture.pixels[i]));
}

void expose(Image& image, float stops) {
    const float scale = std::exp2(stops);
    for (glm::vec3& pixel : image.pixels) pixel *= scale;
}

void print(const CompareOptions& options, const Metrics& metrics, std::optional<double> noise,
           size_t allPixels) {
    if (options.json) {
        // Infinite figures (a black reference) become null, as JSON has no infinity.
        nlohmann::ordered_json report{
            {"test", options.test},     {"reference", options.reference},     {"pixels", metrics.pixels},
            {"relMse", metrics.relMse}, {"maeOverMean", metrics.maeOverMean}, {"bias", metrics.bias},
            {"flip", metrics.flip}};
        if (noise) report["noise"] = *noise;
        fmt::print("{}\n", report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
        return;
    }
    fmt::print("relMSE    {:10.4g}\n", metrics.relMse);
    fmt::print("MAE/mean  {:10.6f}\n", metrics.maeOverMean);
    fmt::print("bias      {:+10.6f}\n", metrics.bias);
    fmt::print("FLIP      {:10.6f}\n", metrics.flip);
    if (noise) fmt::print("noise     {:10.6f}\n", *noise);
    fmt::print("pixels    {:10} of {}\n", metrics.pixels, allPixels);
}

void compare(const CompareOptions& options) {
    Image test = readFinite(options.test);
    Image reference = readFinite(options.reference);
    requireSize(options.test, test, options.reference, reference);
    std::optional<Image> mask;
    if (!options.mask.empty()) {
        mask = readPicture(options.mask);
        requireSize(options.mask, *mask, options.reference, reference);
    }
    std::optional<double> noise;
    if (!options.variance.empty()) {
        const Image variance = readFinite(options.variance);
        requireSize(options.variance, variance, options.reference, reference);
        noise = noiseOverMean(reference, variance, mask ? &*mask : nullptr);
    }
    // Only FLIP notices: the other figures are relative.
    expose(test, options.exposureStops);
    expose(reference, options.exposureStops);

    const Metrics metrics = compareImages(test, reference, mask ? &*mask : nullptr);
    if (metrics.pixels == 0) throw FileError(options.mask, "the mask keeps no pixel (none exceeds 0.5)");
    if (!options.out.empty()) {
        Image picture =
            options.map == Map::flip ? flipPicture(test, reference) : signedPicture(test, reference);
        if (mask) dimOutside(picture, *mask);
        writePng(options.out, picture);
    }
    print(options, metrics, noise, reference.pixels.size());
}

}  // namespace

void addCompareCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("compare", "Measure a picture against a reference");
    CLI::Option* test = command->add_option("TEST", "The picture: .exr, .hdr, .png or .jpg")->required();
    CLI::Option* reference = command->add_option("REFERENCE", "What it should be")->required();
    CLI::Option* mask =
        command->add_option("--mask", "Picture; only pixels above 0.5 count")->type_name("FILE");
    CLI::Option* variance =
        command
            ->add_option("--variance",
                         "The reference's, from phat render: prints the MAE/mean that its noise alone brings")
            ->type_name("FILE.exr");
    CLI::Option* out = command->add_option("--out", "Write a difference picture")->type_name("FILE.png");
    CLI::Option* map =
        command
            ->add_option("--map",
                         "Difference picture: flip (visibility, dark to bright) or signed (relative "
                         "luminance, blue -50 % to red +50 %)")
            ->check(CLI::IsMember({"flip", "signed"}))
            ->default_val("flip");
    CLI::Option* exposure = command->add_option("--exposure", "Stops before FLIP clamps to [0,1]")
                                ->check(CLI::Range(-40.0, 40.0))
                                ->type_name("EV")
                                ->default_val("0");
    CLI::Option* json = command->add_flag("--json")->description("Print JSON");
    command->footer(
        "relMSE, MAE/mean and bias are over linear radiance; FLIP is over the pictures as a screen shows "
        "them.\n"
        "Example: phat compare room.exr room-reference.exr --mask floor.exr --out difference.png");
    command->callback([=] {
        CompareOptions options;
        options.test = test->as<std::string>();
        options.reference = reference->as<std::string>();
        if (*mask) options.mask = mask->as<std::string>();
        if (*variance) options.variance = variance->as<std::string>();
        if (*out) options.out = out->as<std::string>();
        options.map = map->as<std::string>() == "flip" ? Map::flip : Map::signedError;
        options.exposureStops = exposure->as<float>();
        options.json = json->count() > 0;
        compare(options);
    });
}

}  // namespace phat
