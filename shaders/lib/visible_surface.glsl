// The surface at a pixel: material, textures, frame.
#include "lib/slots.glsl"
#include "lib/frame.glsl"
#include "lib/visible_point.glsl"

in vec3 vNormal;
in vec4 vTangent;

uniform sampler2D metallicRoughnessTexture;
uniform sampler2D normalTexture;
uniform sampler2D emissionTexture;
uniform sampler2D specularTexture;
uniform sampler2D specularColorTexture;
uniform sampler2D clearcoatTexture;
uniform sampler2D clearcoatRoughnessTexture;
uniform sampler2D clearcoatNormalTexture;

#ifdef GLASS_TEXTURES
#define TRANSMISSION_TEXTURE
uniform sampler2D thicknessTexture;
#endif
#ifdef TRANSMISSION_TEXTURE
uniform sampler2D transmissionTexture;
#endif

struct VisibleSurface {
    vec3 towardEye;  // this and the next as in VisiblePoint
    vec3 normalGeometric;
    mat3 worldFromLocal;  // local z: the shading normal
    vec3 towardEyeLocal;
    Brdf brdf;
    vec2 texel;  // as in VisiblePoint
    uint chart;
};

vec3 mappedNormal(sampler2D map, int slot, float scale, vec3 normal) {
    if (!slotBound(slot) || dot(vTangent.xyz, vTangent.xyz) < 1e-8) return normal;
    vec3 n = texture(map, slotUv(slot)).xyz * 2.0 - 1.0;
    vec3 bitangent = vTangent.w * cross(normal, vTangent.xyz);
    vec3 mapped = n.x * scale * vTangent.xyz + n.y * scale * bitangent + n.z * normal;
    float size = length(mapped);
    return size > 1e-6 ? mapped / size : normal;
}

float transmissionTexel() {
#ifdef TRANSMISSION_TEXTURE
    return texture(transmissionTexture, slotUv(kSlotTransmission)).r;
#else
    return 1.0;
#endif
}

VisibleSurface visibleSurface(MaterialFactors factors) {
    VisibleSurface s;
    float side = gl_FrontFacing ? 1.0 : -1.0;
    VisiblePoint point = visiblePoint();
    s.towardEye = point.towardEye;
    s.normalGeometric = point.normalGeometric;
    s.texel = point.texel;
    s.chart = point.chart;
    vec3 vertexNormal = normalize(vNormal);
    vec3 normal = side * mappedNormal(normalTexture, kSlotNormal, factors.normalScale, vertexNormal);
    // Interpolated normals may face away from the eye at silhouettes; bend them back just over the edge.
    const float kMinCosine = 1e-3;
    float cosine = dot(normal, s.towardEye);
    if (cosine < kMinCosine) normal = normalize(normal + (kMinCosine - cosine) * s.towardEye);

    vec4 metallicRoughness = texture(metallicRoughnessTexture, slotUv(kSlotMetallicRoughness));
    MaterialTexels texels = MaterialTexels(
        vColor.rgb * texture(baseColorTexture, slotUv(kSlotBaseColor)).rgb, metallicRoughness.g,
        metallicRoughness.b, texture(specularTexture, slotUv(kSlotSpecular)).a,
        texture(specularColorTexture, slotUv(kSlotSpecularColor)).rgb,
        texture(clearcoatTexture, slotUv(kSlotClearcoat)).r,
        texture(clearcoatRoughnessTexture, slotUv(kSlotClearcoatRoughness)).g, transmissionTexel());
    s.worldFromLocal = frameFromNormal(normal);
    vec3 coatNormal =
        mappedNormal(clearcoatNormalTexture, kSlotClearcoatNormal, factors.clearcoatNormalScale, vertexNormal);
    s.brdf = brdfFrom(factors, texels, side * coatNormal * s.worldFromLocal);
    s.towardEyeLocal = s.towardEye * s.worldFromLocal;
    return s;
}
