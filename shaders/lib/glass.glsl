// Glass as a whole, drawn over what lies straight behind it.
// twin: seeStraight in src/core/scene/glass.h; a volume is taken to lie between parallel planes.

const int kGlassVolume = 2;  // Glass::volume of src/core/scene/transparency.h

uniform int glassInterfaces;

float glassThickness(MaterialFactors m) {
#ifdef GLASS_TEXTURES
    return m.thickness * texture(thicknessTexture, slotUv(kSlotThickness)).g;
#else
    return m.thickness;
#endif
}

// Beer's law along the refracted ray.
vec3 glassAttenuation(MaterialFactors m, float nDotV) {
    float ior = max(m.ior, 1.0);
    float inner = sqrt(max(1.0 - (1.0 - nDotV * nDotV) / (ior * ior), 0.0));
    float meters = glassThickness(m) / max(inner, 1e-3);
    return pow(max(m.attenuationColor, vec3(1e-6)), vec3(meters * m.inverseAttenuationDistance));
}

// Of the lobe that scatters what it reflects as much as glass scatters what it lets through. Thin glass is that lobe,
// mirrored. An interface that is tilted by a small angle turns a ray that passes parallel planes by (ior - 1) of it,
// where a mirror turns it by twice the angle; a volume has two such interfaces, independent of each other.
float glassScatteringAlpha(MaterialFactors m, Brdf brdf) {
    if (glassInterfaces != kGlassVolume) return brdf.alpha;
    return brdf.alpha <= kMinAlpha ? kMinAlpha : brdf.alpha * min((m.ior - 1.0) / sqrt(2.0), 1.0);
}

#ifndef SLOTS_ALONE
// Transmittance. Of a volume, whose far side is not drawn: of both sides, with what goes back and forth between
// them, which also makes its specular lobe brighter.
vec3 glassTransmittance(MaterialFactors m, inout VisibleSurface s) {
    vec3 transmittance = interfaceTransmittance(s.brdf, s.towardEyeLocal);
    float nDotV = s.towardEyeLocal.z;
    vec3 left = glassAttenuation(m, nDotV);
    if (glassInterfaces != kGlassVolume) return transmittance * left;
    float reflected = maxComponent(specularAlbedo(s.brdf.f0, s.brdf.f90, s.brdf.alpha, nDotV));
    vec3 series = transmittance * transmittance * left / (1.0 - reflected * reflected * left * left);
    vec3 factor = 1.0 + series * left;
    s.brdf.f0 *= factor;
    s.brdf.f90 *= luminance(factor);
    return series;
}
#endif
