#pragma once
// phat view: a window to walk through a bake.

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "io/phat/scene_lighting.h"
#include "viewer/light_engine.h"

namespace phat {

struct ViewerOptions {
    std::string path;                 // empty: asks for a file
    SceneLighting lighting;           // of a scene that is not baked
    std::string variant;              // of the materials of `path`, a scene that is not baked; empty: none
    std::vector<std::string> things;  // files that are drawn beside the bake
    std::string shaderFolder;
    glm::ivec2 size{1280, 720};
    float uiScale = 0;                  // 0: the screen's
    double frameBudgetSeconds = 0.008;  // of a moving view; rays are traced as it allows
    LightEngine lightEngine = LightEngine::cpu;
};

/// Returns when the window is closed. A file that cannot be opened first throws FileError; later ones are
/// reported in the window. Throws GlError where there is no display or no OpenGL 4.5.
void runViewer(const ViewerOptions& options);

}  // namespace phat
