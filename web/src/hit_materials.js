// Materials as rays read them at what they hit.
// twin: addMaterial in src/gl/hit_tables.cpp, shaders/lib/hit_surface.glsl.
import { ClampToEdgeWrapping, DoubleSide, MirroredRepeatWrapping } from 'three';
import { half } from './file.js';
import { emissionMap, emissionOf, isGlass, isUnlit, metallicRoughnessMap } from './material.js';

export const kNoLayer = 255; // twin: shaders/lib/hit_surface.glsl
// Side of the grid of means that stands for a picture where one number or a few are taken of it (HitImages.meansOf).
export const kMeansSide = 64;
export const kMaterialWords = 20;
const kUnlit = 1,
    kDoubleSided = 2,
    kReadsColors = 4,
    kMirroredU = 16,
    kClampedU = 32,
    kMirroredV = 64,
    kClampedV = 128;

export function matrixOf(texture) {
    if (!texture) return [1, 0, 0, 0, 1, 0, 0, 0, 1];
    if (texture.matrixAutoUpdate) texture.updateMatrix();
    return texture.matrix.elements;
}

function isAtSamePlace(a, b) {
    const sameMatrix = () => matrixOf(a).every((x, i) => x === matrixOf(b)[i]);
    return a.channel === b.channel && a.wrapS === b.wrapS && a.wrapT === b.wrapT && sameMatrix();
}

// The texture by which a material's triangles have their texture coordinates; those of its other pictures that lie
// elsewhere are replaced by their means.
export function placedMap(m) {
    return m.map ?? emissionMap(m) ?? metallicRoughnessMap(m) ?? m.normalMap ?? null;
}

function wrapFlags(texture) {
    const flag = (wrap, mirrored, clamped) =>
        wrap === MirroredRepeatWrapping ? mirrored : wrap === ClampToEdgeWrapping ? clamped : 0;
    return texture
        ? flag(texture.wrapS, kMirroredU, kClampedU) | flag(texture.wrapT, kMirroredV, kClampedV)
        : 0;
}

const words = new Uint32Array(kMaterialWords),
    floats = new Float32Array(words.buffer);

// 1/m: Beer's law.
function absorptionOf(m) {
    const left = m.attenuationColor?.toArray() ?? [1, 1, 1];
    return left.map((x) => -Math.log(Math.max(x, 1e-6)) / (m.attenuationDistance ?? Infinity));
}

// f0 and f90 of what is no metal. source: KHR_materials_specular and KHR_materials_ior.
function dielectric(m, images) {
    const specular = (m.specularIntensity ?? 1) * images.meanOf(m.specularIntensityMap)[3],
        tint = m.specularColor?.toArray() ?? [1, 1, 1],
        mean = images.meanOf(m.specularColorMap),
        ior = m.ior ?? 1.5,
        normal = ((ior - 1) / (ior + 1)) ** 2;
    const f0 = tint.map((x, i) => specular * Math.min(normal * x * mean[i], 1));
    return [...f0, specular * Math.min(Math.max(...f0) / 0.02, 1)];
}

// Words that the next call writes over. `colored`: whether any vertex of the room has a colour.
export function packHitMaterial(m, images, colored) {
    const placed = placedMap(m);
    const layerOf = (texture, layers) =>
        texture && isAtSamePlace(texture, placed) ? (layers.get(texture) ?? kNoLayer) : kNoLayer;
    const color = layerOf(m.map, images.colorLayers),
        emission = layerOf(emissionMap(m), images.colorLayers),
        roughness = layerOf(metallicRoughnessMap(m), images.linearLayers),
        normal = layerOf(m.normalMap, images.linearLayers);
    const times = (rgb, layer, texture) => {
        const mean = layer === kNoLayer ? images.meanOf(texture) : [1, 1, 1];
        return rgb.map((x, i) => x * mean[i]);
    };
    const mean = roughness === kNoLayer ? images.meanOf(metallicRoughnessMap(m)) : [1, 1, 1],
        emitted = emissionOf(m),
        shines = emitted.some((x) => x !== 0);
    floats.set([...times(m.color?.toArray() ?? [1, 1, 1], color, m.map), (m.metalness ?? 1) * mean[2]], 0);
    floats.set([...times(emitted, emission, emissionMap(m)), (m.roughness ?? 1) * mean[1]], 4);
    floats.set(dielectric(m, images), 8);
    const coat = (m.clearcoat ?? 0) * images.meanOf(m.clearcoatMap)[0],
        coatRoughness = (m.clearcoatRoughness ?? 0) * images.meanOf(m.clearcoatRoughnessMap)[1],
        transmission = isGlass(m) ? m.transmission * images.meanOf(m.transmissionMap)[0] : 0;
    words[12] = (half(coat) | (half(coatRoughness) << 16)) >>> 0;
    words[13] = (half(transmission) | (half(m.normalScale?.x ?? 1) << 16)) >>> 0;
    words[14] =
        (isUnlit(m) ? kUnlit : 0) |
        (m.side === DoubleSide ? kDoubleSided : 0) |
        (colored || shines ? kReadsColors : 0) |
        wrapFlags(placed);
    words[15] = (color | (emission << 8) | (roughness << 16) | (normal << 24)) >>> 0;
    floats.set([...absorptionOf(m), m.ior ?? 1.5], 16);
    return words;
}

// All of a material that the tables of triangles, emitters and pictures depend on, as a text.
export function structureOf(m) {
    const maps = [
        m.map,
        emissionMap(m),
        metallicRoughnessMap(m),
        m.normalMap,
        m.specularIntensityMap,
        m.specularColorMap,
        m.clearcoatMap,
        m.clearcoatRoughnessMap,
        m.transmissionMap,
        m.thicknessMap,
    ];
    const place = (t) => (t ? [t.uuid, t.version, t.channel, t.wrapS, t.wrapT, ...matrixOf(t)] : 0);
    const shines = emissionOf(m).some((x) => x > 0);
    const glass = isGlass(m) && m.thickness;
    return `${shines} ${glass} ${m.side} ${m.transparent} ${m.opacity} ${m.alphaTest} ${maps.map(place)}`;
}
