#include "gl/tile_bounds_pass.h"

#include "core/atlas/atlas.h"
#include "core/scene/light_bound.h"
#include "gl/gl_error.h"
#include "gl/textures.h"

namespace phat {
namespace {

/// While it lives, the fraction of area lights in the fourth channel is not written.
class BoundsAlone {
  public:
    BoundsAlone() { glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE); }
    ~BoundsAlone() { glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE); }
    BoundsAlone(const BoundsAlone&) = delete;
    BoundsAlone& operator=(const BoundsAlone&) = delete;
};

}  // namespace

TileBoundsPass createTileBoundsPass(const std::string& folder, const GpuAtlas& atlas) {
    TileBoundsPass pass;
    pass.brightest = FullscreenProgram(folder, "bound_tiles.frag", {"FIRST"});
    pass.bounds = FullscreenProgram(folder, "bound_tiles.frag");
    const glm::uvec2 tiles = atlas.sizeTexels / kTileSize;
    for (GlTexture* texture : {&pass.indirect, &pass.area}) *texture = createTexture2D(GL_RGBA32F, tiles);
    pass.brightestTarget = createFramebuffer({{pass.indirect.name()}, {pass.area.name()}});
    pass.boundsTarget = createFramebuffer({{atlas.tileLight.name()}});
    checkGl("creating the pass that bounds radiance");
    return pass;
}

void unboundTiles(const TileBoundsPass& pass) {
    const BoundsAlone alone;
    const glm::vec4 unbounded(kUnbounded);
    glClearNamedFramebufferfv(pass.boundsTarget.name(), GL_COLOR, 0, &unbounded.x);
}

void boundTiles(const TileBoundsPass& pass, const GpuAtlas& atlas, glm::vec3 brightest) {
    glDisable(GL_BLEND);
    const glm::uvec2 tiles = atlas.sizeTexels / kTileSize;
    const ShaderProgram& first = pass.brightest.program;
    first.bind("phatexels", 0, atlas.phatexels.name());
    first.set("layerCount", atlas.sources[0].layerCount);
    first.set("unitMeters", atlas.unitMeters);
    pass.brightest.draw(pass.brightestTarget, tiles);
    const ShaderProgram& bounds = pass.bounds.program;
    bounds.bind("indirect", 0, pass.indirect.name());
    bounds.bind("area", 1, pass.area.name());
    bounds.bind("tileTable", 2, atlas.tileTable.name());
    bounds.set("brightest", brightest);
    const BoundsAlone alone;
    pass.bounds.draw(pass.boundsTarget, tiles);
    checkGl("bounding radiance");
}

}  // namespace phat
