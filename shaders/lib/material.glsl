// A material's factors and texture values to a Brdf.
// twin: surfaceAt in src/core/scene/shading.h; src/gl/material_table.cpp writes the rows.
#include "lib/brdf.glsl"

// Rows of a material, in this order. Slots follow, two rows each:
// (m00 m10 m20 uvSet) and (m01 m11 m21 bound) of the texture transform.
const int kFactorRows = 7;
const int kSlotBaseColor = 7;
const int kSlotMetallicRoughness = 9;
const int kSlotNormal = 11;
const int kSlotEmission = 13;
const int kSlotSpecular = 15;
const int kSlotSpecularColor = 17;
const int kSlotClearcoat = 19;
const int kSlotClearcoatRoughness = 21;
const int kSlotClearcoatNormal = 23;
const int kSlotTransmission = 25;
const int kSlotThickness = 27;
const int kMaterialRows = 29;

struct MaterialFactors {
    vec4 baseColor;
    vec3 emission;
    float normalScale;
    float metallic;
    float roughness;
    float specular;
    float ior;
    vec3 specularColor;
    float alphaCutoff;
    float clearcoat;
    float clearcoatRoughness;
    float clearcoatNormalScale;
    bool unlit;
    float transmission;
    float thickness;
    float inverseAttenuationDistance;
    vec3 attenuationColor;
};

MaterialFactors unpackFactors(vec4 rows[kFactorRows]) {
    return MaterialFactors(rows[0], rows[1].rgb, rows[1].a, rows[2].x, rows[2].y, rows[2].z, rows[2].w,
                           rows[3].rgb, rows[3].a, rows[4].x, rows[4].y, rows[4].z, rows[4].w > 0.5,
                           rows[5].x, rows[5].y, rows[5].z, rows[6].rgb);
}

// The values of the textures at one point; white where there are none.
struct MaterialTexels {
    vec3 baseColor;  // with the vertex colour
    float roughness;
    float metallic;
    float specular;
    vec3 specularColor;
    float clearcoat;
    float clearcoatRoughness;
    float transmission;
};

Brdf brdfFrom(MaterialFactors m, MaterialTexels t, vec3 clearcoatNormal) {
    Brdf brdf = Brdf(vec3(0.0), vec3(0.0), 0.0, 1.0, 0.0, kMinAlpha, vec3(0.0, 0.0, 1.0), 0.0, vec3(0.0));
    if (m.unlit) return brdf;
    vec3 base = clamp(m.baseColor.rgb * t.baseColor, 0.0, 1.0);
    float metallic = clamp(m.metallic * t.metallic, 0.0, 1.0);
    float roughness = clamp(m.roughness * t.roughness, 0.0, 1.0);
    float specular = m.specular * t.specular;

    // KHR_materials_specular and KHR_materials_ior.
    float iorRatio = (m.ior - 1.0) / (m.ior + 1.0);
    vec3 dielectricF0 = specular * min(iorRatio * iorRatio * m.specularColor * t.specularColor, vec3(1.0));
    float dielectricF90 = specular * min(maxComponent(dielectricF0) / 0.02, 1.0);

    brdf.diffuseColor = base * (1.0 - metallic) * (1.0 - meanFresnel(maxComponent(dielectricF0), dielectricF90));
    if (m.transmission > 0.0) {
        brdf.transmission = clamp(m.transmission * t.transmission, 0.0, 1.0);
        brdf.diffuseColor *= 1.0 - brdf.transmission;
        brdf.transmissionColor = brdf.transmission * (1.0 - metallic) * base;
    }
    brdf.f0 = mix(dielectricF0, base, metallic);
    brdf.f90 = mix(dielectricF90, 1.0, metallic);
    brdf.alpha = max(roughness * roughness, kMinAlpha);
    brdf.clearcoat = clamp(m.clearcoat * t.clearcoat, 0.0, 1.0);
    if (brdf.clearcoat > 0.0) {
        float coatRoughness = clamp(m.clearcoatRoughness * t.clearcoatRoughness, 0.0, 1.0);
        brdf.clearcoatAlpha = max(coatRoughness * coatRoughness, kMinAlpha);
        brdf.clearcoatNormal = clearcoatNormal;
    }
    return brdf;
}
