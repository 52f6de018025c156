// phat web: a folder that any web server can host, with a baked room to walk through.

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "cli/commands.h"
#include "cli/data_folders.h"
#include "cli/exposure.h"
#include "cli/interrupt.h"
#include "cli/owned_folder.h"
#include "cli/progress_bar.h"
#include "cli/render_methods.h"
#include "cli/render_options.h"
#include "core/scene/default_camera.h"
#include "core/scene/enclosure.h"
#include "io/base/content_name.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_source.h"
#include "io/phat/phat_payload.h"
#include "io/phat/scene_file.h"
#include "io/phat/web_parts.h"

namespace phat {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPartsStem = "room";
constexpr const char* kPage = "index.html";
constexpr const char* kPoster = "poster.jpg";  // pages that link to this one may show it
constexpr int kPosterWidth = 960, kMinPosterWidth = 64, kMaxPosterWidth = 3840;

struct WebOptions {
    std::string input, site, title, description;
    std::string url;                     // of the page, with a slash at its end; empty: not known
    std::optional<float> exposureStops;  // none: the poster's own
    int posterWidth = kPosterWidth;
    bool quiet = false;
};

constexpr const char* kNotBuilt = "the viewer is not built; `make web` does it";

std::string readText(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    if (!file) throw FileError(path.string(), kNotBuilt);
    return text;
}

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    return result;
}

// Wherever the page has it.
void fill(std::string& page, const std::string& placeholder, const std::string& value) {
    size_t at = page.find(placeholder);
    if (at == std::string::npos) throw FileError(siteFolder(), "the viewer was built by another version");
    for (; at != std::string::npos; at = page.find(placeholder, at + value.size()))
        page.replace(at, placeholder.size(), value);
}

// The viewer's files by their names, but the page itself.
std::map<std::string, std::string> readViewer(const fs::path& built) {
    std::error_code error;
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(built, error))
        if (const std::string name = entry.path().filename().string(); name != kPage)
            files[name] = readText(entry.path());
    if (error) throw FileError(built.string(), kNotBuilt);
    return files;
}

std::span<const uint8_t> bytesOf(const std::string& text) {
    return phat::bytesOf(std::span<const char>(text));
}

// A file that is gone when this is.
struct TemporaryFile {
    explicit TemporaryFile(std::string file) : path(std::move(file)) {}
    ~TemporaryFile() { unlink(path.c_str()); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    std::string path;
};

struct Poster {
    std::vector<uint8_t> jpeg;
    double exposureStops;
};

Poster drawPoster(const WebOptions& options, const OwnedFolder& site, SceneFile& scene, Progress& progress) {
    const TemporaryFile file(site.file(fmt::format("poster.tmp-{}.jpg", getpid())));
    RenderOptions poster;
    poster.input = options.input;
    poster.output = file.path;
    poster.width = options.posterWidth;
    poster.exposureStops = options.exposureStops;
    const double stops = renderRead(poster, scene, progress).front().at("exposure").at("stops").get<double>();
    const std::string bytes = readText(file.path);
    return {{bytes.begin(), bytes.end()}, stops};
}

bool isPerspective(const Camera& camera) {
    return camera.perspective;
}

// Eye, target and field of view in degrees of a file without a camera that pages show by; else nothing.
std::string defaultCameraOf(const RayScene& rays) {
    const Scene& scene = rays.scene();
    if (std::any_of(scene.cameras.begin(), scene.cameras.end(), isPerspective)) return "";
    const DefaultView view = defaultView(rays, LightSampler(scene));
    const glm::vec3 eye(view.camera.worldFromCamera[3]);
    return fmt::format("{} {} {} {} {} {} {}", eye.x, eye.y, eye.z, view.target.x, view.target.y,
                       view.target.z, glm::degrees(view.camera.yfovRadians));
}

// Corners of boxes, low and high, in which an eye is inside.
std::string roomsOf(const RayScene& rays) {
    std::string text;
    for (const Bounds& box : roomBoxes(rays))
        text += fmt::format("{}{:.5g} {:.5g} {:.5g} {:.5g} {:.5g} {:.5g}", text.empty() ? "" : " ", box.low.x,
                            box.low.y, box.low.z, box.high.x, box.high.y, box.high.z);
    return text;
}

// What previews of links and search engines say.
std::string descriptionOf(const std::string& title, const Scene& scene) {
    const auto viewpoints = std::count_if(scene.cameras.begin(), scene.cameras.end(), isPerspective);
    return fmt::format(
        "{}: walk through it in the browser{}. {} materials in light that was baked by PHATextures.", title,
        viewpoints > 1 ? fmt::format(", from {} viewpoints", viewpoints) : "", scene.materials.size());
}

// The page with all but what is known when the poster is drawn.
std::string readPage(const WebOptions& options, const Scene& scene) {
    std::string page = readText(fs::path(siteFolder()) / kPage);
    const std::string name = fs::path(options.input).filename().string(),
                      title = options.title.empty() ? name.substr(0, name.find('.')) : options.title;
    const RayScene rays(scene);
    const std::string& given = options.description;
    fill(page, "@DESCRIPTION@", escaped(given.empty() ? descriptionOf(title, scene) : given));
    fill(page, "@TITLE@", escaped(title));
    fill(page, "@ADDRESS@", escaped(options.url));
    fill(page, "@CAMERA@", defaultCameraOf(rays));
    fill(page, "@ROOMS@", roomsOf(rays));
    return page;
}

// All that was written, and what a page needs for its first picture.
void reportSizes(const std::string& site, const std::vector<OutputFile>& files, const WebParts& parts,
                 const std::string& page) {
    uint64_t all = 0, first = parts.room.bytes.size();
    for (const auto& [name, bytes] : files) {
        all += bytes.size();
        if (name.ends_with(".js") && page.find('"' + name + '"') != std::string::npos) first += bytes.size();
    }
    fmt::print("{}: {:.1f} MB; a first picture after {:.1f} MB\n", site, double(all) * 1e-6,
               double(first) * 1e-6);
}

void writeSite(const WebOptions& options) {
    GltfSource source = openGltf(options.input);
    if (!isBakedFile(source)) throw FileError(options.input, "is not a baked file: `phat bake` makes one");
    if (phatexelStorage(source) != PhatexelStorage::packed)
        throw FileError(
            options.input,
            "has PHATexels in the paper's storage, which pages do not read: bake without --storage paper");
    const std::map<std::string, std::string> viewer = readViewer(siteFolder());
    std::set<std::string> names{kPage, kPoster};
    for (const auto& [name, text] : viewer) names.insert(name);
    const WebParts parts = splitForWeb(source, kPartsStem);
    SceneFile scene{readBakedFile(source), {}};
    std::string page = readPage(options, scene.baked.loaded.scene);
    OwnedFolder site(kPageFolder, options.site, options.input, names);
    catchInterrupts();
    ProgressBar progress(progressStyle(options.quiet), {});
    const Poster poster = drawPoster(options, site, scene, progress);
    fill(page, "@EXPOSURE@", fmt::format("{}", poster.exposureStops));
    fill(page, "@ROOM@", parts.room.uri);
    fill(page, "@POSTER@", std::string(kPoster) + "?" + contentHash(poster.jpeg));
    std::vector<OutputFile> files;
    for (const WebPart& part : parts.later) files.push_back({part.uri, part.bytes});
    files.push_back({parts.room.uri, parts.room.bytes});
    files.push_back({kPoster, poster.jpeg});
    for (const auto& [name, text] : viewer) files.push_back({name, bytesOf(text)});
    files.push_back({kPage, bytesOf(page)});  // the last, so that whoever loads it finds all the others
    site.write(files);
    if (!options.quiet) reportSizes(options.site, files, parts, page);
}

}  // namespace

void addWebCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("web", "Write a page that shows a baked file, for any web server");
    CLI::Option* input = command->add_option("IN", "A .phat.glb file")->required();
    CLI::Option* site =
        command->add_option("-o,--output", "Folder of the page: a new or empty one, or that of an older page")
            ->type_name("SITE")
            ->required();
    CLI::Option* title =
        command->add_option("--title", "Of the page; default: the file's name")->type_name("TEXT");
    const auto exposure = std::make_shared<std::optional<float>>();
    declareExposure(*command, *exposure);
    CLI::Option* description =
        command->add_option("--description", "Of the page, for link previews; default: from the file")
            ->type_name("TEXT");
    CLI::Option* url =
        command->add_option("--url", "Where the page will be; link previews show its poster then")
            ->type_name("URL")
            ->check([](const std::string& text) {
                return text.starts_with("https://") || text.starts_with("http://")
                           ? ""
                           : "must begin with https:// or http://";
            });
    CLI::Option* posterWidth = command->add_option("--poster-width", "Of the picture that is there at once")
                                   ->type_name("PIXELS")
                                   ->check(CLI::Range(kMinPosterWidth, kMaxPosterWidth))
                                   ->default_val(kPosterWidth);
    CLI::Option* quiet = command->add_flag("--quiet")->description("Say nothing");
    command->footer(
        "The folder is complete: no other site is asked for anything. One with files of others is refused;\n"
        "what is put beside a page later stays. Browsers load it from a web server\n"
        "only, e.g.: python3 -m http.server --directory room-site\n"
        "Example: phat web room.phat.glb -o room-site");
    command->callback([=] {
        WebOptions options;
        options.input = input->as<std::string>();
        options.site = site->as<std::string>();
        if (*title) options.title = title->as<std::string>();
        if (*description) options.description = description->as<std::string>();
        if (*url) options.url = url->as<std::string>();
        if (!options.url.empty() && !options.url.ends_with('/')) options.url += '/';
        options.exposureStops = *exposure;
        options.posterWidth = posterWidth->as<int>();
        options.quiet = quiet->count() > 0;
        writeSite(options);
    });
}

}  // namespace phat
