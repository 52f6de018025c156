#pragma once
// A glTF scene flattened to world space; no stage changes it.
//
// Units are glTF's: metres, candela, lux, nit, used as W/sr, W/m2 and W/(m2 sr) without a factor of 683.
// Colours are linear Rec. 709. World space is right-handed, +Y up.

#include <limits>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/math.h"
#include "core/scene/animation.h"
#include "core/scene/photometry.h"
#include "core/scene/shared_value.h"

namespace phat {

/// 8-bit RGBA picture, [y][x], row 0 on top, exactly as decoded: colour slots apply the sRGB curve on lookup.
struct TextureImage {
    std::string name;
    int width = 0;
    int height = 0;
    std::vector<glm::u8vec4> texels;
};

enum class Wrap : uint8_t { repeat, mirroredRepeat, clampToEdge };

/// A use of an image by a material. `image` < 0: no texture, the lookup returns white.
struct TextureSlot {
    int32_t image = -1;
    int32_t uvSet = 0;  // 0 or 1
    Wrap wrapU = Wrap::repeat;
    Wrap wrapV = Wrap::repeat;
    bool nearest = false;
    glm::mat3x2 uvTransform{1, 0, 0, 1, 0, 0};  // KHR_texture_transform: uv' = uvTransform * (u, v, 1)

    bool operator==(const TextureSlot&) const = default;
};

enum class AlphaMode : uint8_t { opaque, mask, blend };

/// glTF 2.0 metallic-roughness with specular, ior, clearcoat, transmission, volume,
/// emissive_strength and unlit.
struct Material {
    std::string name;
    glm::vec4 baseColor{1};
    TextureSlot baseColorTexture;  // sRGB, alpha
    float metallic = 1;
    float roughness = 1;
    TextureSlot metallicRoughnessTexture;  // G roughness, B metallic
    float normalScale = 1;
    TextureSlot normalTexture;
    glm::vec3 emission{0};        // nit: emissiveFactor * emissiveStrength; baseColor when unlit
    TextureSlot emissionTexture;  // sRGB; the base colour's when unlit
    float specular = 1;
    TextureSlot specularTexture;  // A
    glm::vec3 specularColor{1};
    TextureSlot specularColorTexture;  // sRGB
    float ior = 1.5f;
    float clearcoat = 0;
    float clearcoatRoughness = 0;
    float clearcoatNormalScale = 1;
    TextureSlot clearcoatTexture;           // R
    TextureSlot clearcoatRoughnessTexture;  // G
    TextureSlot clearcoatNormalTexture;
    float transmission = 0;
    TextureSlot transmissionTexture;  // R
    float thickness = 0;              // units of the mesh; 0: infinitely thin, else it bounds a volume
    TextureSlot thicknessTexture;     // G
    glm::vec3 attenuationColor{1};    // what is left of white light after attenuationDistance
    float attenuationDistance = std::numeric_limits<float>::infinity();  // metres
    AlphaMode alphaMode = AlphaMode::opaque;
    float alphaCutoff = 0.5f;
    bool doubleSided = false;
    bool unlit = false;  // radiance is `emission`, nothing is reflected

    bool operator==(const Material&) const = default;
};

/// One primitive of one node's mesh: a contiguous range of triangles and of vertices.
struct Surface {
    std::string name;   // the node's, or the mesh's, or "node N"
    uint32_t node = 0;  // glTF indices, to find the way back into the file
    uint32_t mesh = 0;
    uint32_t primitive = 0;
    uint32_t material = 0;
    uint32_t firstTriangle = 0;
    uint32_t triangleCount = 0;
    uint32_t firstVertex = 0;
    uint32_t vertexCount = 0;
    float metersPerUnit = 1;  // of Material::thickness: the node's scale along the surface's normals
};

struct PunctualLight {
    enum class Type : uint8_t { point, spot, directional };
    std::string name;
    Type type = Type::point;
    glm::vec3 intensity{0};  // colour * intensity: W/sr, or W/m2 for directional
    glm::vec3 position{0};
    glm::vec3 direction{0, 0, -1};       // of propagation; unit
    SharedValue<Photometry> photometry;  // of a point light: `intensity` is that of its peak
    glm::vec3 horizontalZero{1, 0, 0};   // of the photometry's horizontal angle; unit, across `direction`
    float angularRadius = 0;             // of a directional light that is a disc; radians
    float cosInnerCone = 1;
    float cosOuterCone = 0.70710678f;
    float rangeMeters = 0;  // 0: unlimited
    uint32_t node = 0;      // glTF index, to find the way back into the file

    bool operator==(const PunctualLight&) const = default;
};

struct Camera {
    std::string name;
    glm::mat4 worldFromCamera{1};  // looks down -z, +y up
    bool perspective = true;
    float yfovRadians = 0.8f;  // perspective
    float aspect = 0;          // width / height; 0: the picture's
    float ymag = 1;            // orthographic: half the height in metres
    float znear = 0;           // 0: near enough for what there is to see
};

/// Light from infinity. Latitude-longitude picture: column 0 at azimuth atan2(z, x) = -pi, growing;
/// row 0 at +Y.
struct Environment {
    Image radiance;
};

/// Positions, normals etc. are per vertex and in world space; a vertex belongs to one surface.
struct Scene {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;   // unit
    std::vector<glm::vec4> tangents;  // xyz unit, w = handedness; 0 where no normal map needs one
    std::vector<glm::vec2> uv0;
    std::vector<glm::vec2> uv1;
    std::vector<glm::vec4> colors;      // linear, multiplies the base colour
    std::vector<glm::uvec3> triangles;  // counter-clockwise from the front, also under mirrored nodes
    std::vector<uint32_t> triangleSurface;
    std::vector<Surface> surfaces;
    std::vector<Material> materials;
    std::vector<SharedValue<TextureImage>> images;  // never none
    std::vector<PunctualLight> lights;
    std::vector<Camera> cameras;
    SharedValue<Environment> environment;
    std::vector<SceneNode> nodes;  // [glTF index]; the arrays above are in world space and need them not
    std::vector<Animation> animations;

    const Material& materialOf(uint32_t triangle) const {
        return materials[surfaces[triangleSurface[triangle]].material];
    }
};

struct Bounds {
    glm::vec3 low{1e30f};
    glm::vec3 high{-1e30f};

    void add(glm::vec3 p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    bool empty() const { return low.x > high.x; }
    float diagonal() const { return empty() ? 0.0f : glm::distance(low, high); }
    glm::vec3 center() const { return 0.5f * (low + high); }
};

/// Box around all triangles (unused vertices do not count).
Bounds boundsOf(const Scene& scene);

}  // namespace phat
