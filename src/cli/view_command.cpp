// phat view: a window.

#include <CLI/CLI.hpp>
#include <array>

#include "cli/commands.h"
#include "cli/data_folders.h"
#include "cli/declare_option.h"
#include "cli/lighting_options.h"
#include "cli/size_option.h"
#include "io/phat/baked_file.h"
#include "viewer/viewer.h"

namespace phat {
namespace {

constexpr std::array<FlagName<LightEngine>, 2> kEngineNames = {
    {{"cpu", LightEngine::cpu}, {"gpu", LightEngine::gpu}}};

}  // namespace

void addViewCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("view", "Walk through a baked file, or watch a scene being baked");
    CLI::Option* input =
        command->add_option("IN", "A baked file or a scene; more can be dropped on the window")
            ->type_name("FILE");
    const auto lighting = std::make_shared<SceneLighting>();
    declareLighting({*command}, *lighting);
    const auto variant = std::make_shared<std::string>();
    command
        ->add_option("--variant", *variant,
                     "Material variant of a scene that is not baked; phat info lists them")
        ->type_name("NAME")
        ->needs(input);
    const auto things = std::make_shared<std::vector<std::string>>();
    command
        ->add_option("--with", *things,
                     "Things that are not in the bake, where their own file puts them; again for more files")
        ->type_name("FILE")
        ->allow_extra_args(false);
    CLI::Option* size = command->add_option("--size", "Of the window; default: 1280x720")->type_name("WxH");
    CLI::Option* scale = command->add_option("--ui-scale", "Size of the panels; default: the screen's")
                             ->type_name("FACTOR")
                             ->check(CLI::Range(0.5, 4.0));
    CLI::Option* budget =
        command
            ->add_option("--frame-budget",
                         "Of a moving view: reflection rays are traced as it allows; default: 8")
            ->type_name("MS")
            ->check(CLI::Range(1.0, 1000.0));
    const auto engine = std::make_shared<LightEngine>(LightEngine::cpu);
    DeclareOption{*command}.choice(
        "--engine", kEngineNames, *engine,
        "Which processor updates the light after changes; software drivers are too slow for gpu");
    command->footer("Example: phat view room.phat.glb");
    command->callback([=] {
        ViewerOptions options;
        if (*input) options.path = input->as<std::string>();
        options.lighting = *lighting;
        options.variant = *variant;
        options.things = *things;
        if (!variant->empty() && isBakedFile(options.path))
            throw CLI::ValidationError("--variant", "the bake is of one variant; bake the scene again");
        if (*size) options.size = parseSize(size);
        if (*scale) options.uiScale = scale->as<float>();
        if (*budget) options.frameBudgetSeconds = 1e-3 * budget->as<double>();
        options.lightEngine = *engine;
        options.shaderFolder = shaderFolder();
        runViewer(options);
    });
}

}  // namespace phat
