#include "core/bake/stage_keys.h"

#include <map>

#include "core/base/fingerprint.h"
#include "core/phatexel/directions.h"

namespace phat {
namespace {

template <int N>
void addVector(Fingerprint& to, const glm::vec<N, float>& v) {
    for (int i = 0; i < N; ++i) to.add(v[i]);
}

void addTexture(Fingerprint& to, const TextureSlot& slot, const std::vector<uint64_t>& images) {
    to.add(slot.image < 0 ? uint64_t(0) : images[size_t(slot.image)]);
    to.add(uint64_t(slot.uvSet));
    to.add(uint64_t(slot.wrapU));
    to.add(uint64_t(slot.wrapV));
    to.add(uint64_t(slot.nearest));
    for (int column = 0; column < 3; ++column) addVector(to, slot.uvTransform[column]);
}

// All but the name.
uint64_t materialKey(const Material& m, const std::vector<uint64_t>& images) {
    Fingerprint key;
    addVector(key, m.baseColor);
    addVector(key, m.emission);
    addVector(key, m.specularColor);
    addVector(key, m.attenuationColor);
    for (const float number :
         {m.metallic, m.roughness, m.normalScale, m.specular, m.ior, m.clearcoat, m.clearcoatRoughness,
          m.clearcoatNormalScale, m.transmission, m.thickness, m.attenuationDistance, m.alphaCutoff})
        key.add(number);
    for (const TextureSlot* slot :
         {&m.baseColorTexture, &m.metallicRoughnessTexture, &m.normalTexture, &m.emissionTexture,
          &m.specularTexture, &m.specularColorTexture, &m.clearcoatTexture, &m.clearcoatRoughnessTexture,
          &m.clearcoatNormalTexture, &m.transmissionTexture, &m.thicknessTexture})
        addTexture(key, *slot, images);
    key.add(uint64_t(m.alphaMode));
    key.add(uint64_t(m.doubleSided));
    key.add(uint64_t(m.unlit));
    return key.value();
}

bool shines(const Material& m) {
    return m.unlit || m.emission != glm::vec3(0);
}

bool letsThrough(const Material& m) {
    return m.alphaMode != AlphaMode::opaque || m.transmission > 0;
}

// What a material may do to the light that a stage looks at.
enum class MaterialPart {
    all,
    emission,  // and what is in its way
    opacity,   // what is in the way of light
};

uint64_t partKey(const Material& m, MaterialPart part, const std::vector<uint64_t>& images) {
    Fingerprint key;
    const bool whole =
        part == MaterialPart::all || letsThrough(m) || (part == MaterialPart::emission && shines(m));
    key.add(uint64_t(whole));
    key.add(uint64_t(m.doubleSided));
    // Glass that shines lets nothing through.
    key.add(uint64_t(shines(m)));
    if (whole) key.add(materialKey(m, images));
    return key.value();
}

uint64_t imageKey(const TextureImage& image) {
    Fingerprint key;
    key.add(uint64_t(image.width));
    key.add(uint64_t(image.height));
    key.addAll(image.texels);
    return key.value();
}

uint64_t surfacesKey(const Scene& scene) {
    Fingerprint to;
    to.addAll(scene.positions);
    to.addAll(scene.normals);
    to.addAll(scene.tangents);
    to.addAll(scene.uv0);
    to.addAll(scene.uv1);
    to.addAll(scene.colors);
    to.addAll(scene.triangles);
    // Which surfaces are of one node counts, and not the numbers that a file gives to nodes.
    std::map<uint32_t, uint64_t> nodes;
    for (const Surface& surface : scene.surfaces) {
        to.add(nodes.try_emplace(surface.node, nodes.size()).first->second);
        for (const uint32_t number :
             {surface.firstTriangle, surface.triangleCount, surface.firstVertex, surface.vertexCount})
            to.add(uint64_t(number));
        to.add(surface.metersPerUnit);
    }
    return to.value();
}

void addEnvironment(Fingerprint& to, const Scene& scene) {
    to.add(uint64_t(bool(scene.environment)));
    if (!scene.environment) return;
    to.add(uint64_t(scene.environment->radiance.width));
    to.addAll(scene.environment->radiance.pixels);
}

void addPhotometry(Fingerprint& to, const SharedValue<Photometry>& photometry) {
    to.add(uint64_t(bool(photometry)));
    if (!photometry) return;
    const PhotometricWeb& web = photometry->web();
    to.add(web.peakCandela);
    to.add(uint64_t(web.horizontalSteps));
    to.addAll(web.relative);
}

void addPunctualLights(Fingerprint& to, const Scene& scene) {
    to.add(uint64_t(scene.lights.size()));
    for (const PunctualLight& light : scene.lights) {
        to.add(uint64_t(light.type));
        addVector(to, light.intensity);
        addVector(to, light.position);
        addVector(to, light.direction);
        addVector(to, light.horizontalZero);
        addPhotometry(to, light.photometry);
        for (const float number :
             {light.angularRadius, light.cosInnerCone, light.cosOuterCone, light.rangeMeters})
            to.add(number);
    }
}

void addAtlasSettings(Fingerprint& to, const AtlasSettings& atlas) {
    for (const float number : {atlas.texelSizeMeters, atlas.glossyDensity, atlas.maxNormalConeDegrees})
        to.add(number);
    for (const uint64_t number : {atlas.texelBudget, uint64_t(atlas.gutterTexels),
                                  uint64_t(atlas.maxSizeTexels), uint64_t(int64_t(atlas.useUvSet))})
        to.add(number);
}

}  // namespace

SceneKeys::SceneKeys(const Scene& scene) : scene_(scene), surfaces_(surfacesKey(scene)) {
    std::vector<uint64_t> images;
    for (const SharedValue<TextureImage>& image : scene.images) images.push_back(imageKey(*image));
    const auto keyOf = [&](MaterialPart part) {
        Fingerprint key;
        std::vector<uint64_t> materials;
        for (const Material& material : scene.materials) materials.push_back(partKey(material, part, images));
        for (const Surface& surface : scene.surfaces) key.add(materials[surface.material]);
        return key.value();
    };
    materials_ = {keyOf(MaterialPart::all), keyOf(MaterialPart::emission), keyOf(MaterialPart::opacity)};
}

uint64_t SceneKeys::ofAll(const BakeSettings& settings) const {
    Fingerprint key;
    key.add(surfaces_);
    key.add(materials_.all);
    addEnvironment(key, scene_);
    addPunctualLights(key, scene_);
    addAtlasSettings(key, settings.atlas);
    const PhotonSettings& photons = settings.photons;
    const DensityEstimate& density = settings.density;
    for (const uint64_t number :
         {photons.count, uint64_t(photons.maxBounces), photons.seed, uint64_t(density.neighbors),
          uint64_t(settings.directions), uint64_t(settings.radiance), uint64_t(settings.layers),
          uint64_t(settings.pathsPerPhatexel), uint64_t(settings.maxBounces),
          uint64_t(settings.irradianceSamples), settings.seed, uint64_t(settings.dynamic)})
        key.add(number);
    return key.value();
}

uint64_t SceneKeys::ofGeometry(const Atlas& atlas) const {
    Fingerprint key;
    key.add(surfaces_);
    key.add(materials_.opacity);
    key.add(uint64_t(atlas.sizeTexels.x));
    key.add(atlas.unitMeters);
    for (const Chart& chart : atlas.charts) {
        for (const uint32_t number : {chart.originTile.x, chart.originTile.y, chart.sizeTiles.x,
                                      chart.sizeTiles.y, uint32_t(chart.back), chart.otherSide})
            key.add(uint64_t(number));
        key.add(chart.texelSizeMeters);
    }
    key.addAll(atlas.triangleChart);
    key.addAll(atlas.triangleTexels);
    key.addAll(atlas.tileChart);
    return key.value();
}

uint64_t SceneKeys::ofAreaIrradiance(uint64_t geometry, const BakeSettings& settings) const {
    Fingerprint key;
    key.add(geometry);
    key.add(materials_.emission);
    addEnvironment(key, scene_);
    key.add(uint64_t(settings.irradianceSamples));
    key.add(settings.seed);
    return key.value();
}

uint64_t keyOfAreaLight(uint64_t areaIrradiance, const PhotonMap& photons, const BakeSettings& settings) {
    Fingerprint key;
    key.add(areaIrradiance);
    key.add(settings.seed);
    key.add(photons.unitMeters);
    for (const Photon& photon : photons.photons) {
        if (!isAreaPhoton(photon)) continue;
        for (const glm::vec3& v : {photon.position, photon.fluxWatts, photon.towardOrigin, photon.normal})
            addVector(key, v);
        key.add(uint64_t(photon.triangle) << 1 | uint64_t(photon.backFace));
    }
    return key.value();
}

}  // namespace phat
