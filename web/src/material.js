// A three.js material as the rows that the shaders read.
// twin: src/gl/material_table.cpp, shaders/lib/material.glsl.

export const kMaterialRows = 29;
const kFactorRows = 7;

// The texture slots in the order of the rows, with the sampler that each feeds. three.js may hold the two
// channels of metallicRoughness apart; glTF does not.
export const kSlots = [
    ['baseColorTexture', (m) => m.map],
    ['metallicRoughnessTexture', metallicRoughnessMap],
    ['normalTexture', (m) => m.normalMap],
    ['emissionTexture', () => null], // three.js adds what shines
    ['specularTexture', (m) => m.specularIntensityMap],
    ['specularColorTexture', (m) => m.specularColorMap],
    ['clearcoatTexture', (m) => m.clearcoatMap],
    ['clearcoatRoughnessTexture', (m) => m.clearcoatRoughnessMap],
    ['clearcoatNormalTexture', (m) => m.clearcoatNormalMap],
    ['transmissionTexture', (m) => m.transmissionMap],
];
// The first slots, which all programs that shade a surface read; the display pass reads the others, too.
export const kOpaqueSlots = 9;

export function hasClearcoat(material) {
    return material.clearcoat > 0;
}

export function metallicRoughnessMap(m) {
    return m.roughnessMap ?? m.metalnessMap ?? null;
}

// Materials without shading shine by their base colour.
export function isUnlit(m) {
    return !m.isMeshStandardMaterial;
}

// What shines, without its picture: linear RGB.
export function emissionOf(m) {
    if (isUnlit(m)) return m.color?.toArray() ?? [1, 1, 1];
    return m.emissive.toArray().map((x) => m.emissiveIntensity * x);
}

export function emissionMap(m) {
    return (isUnlit(m) ? m.map : m.emissiveMap) ?? null;
}

// twin: isGlass in src/core/scene/transparency.h
export function isGlass(material) {
    const shines = material.emissiveIntensity > 0 && material.emissive?.getHex() > 0;
    return material.transmission > 0 && !shines;
}

export const kOpaque = 0,
    kMask = 1,
    kBlend = 2;
export function alphaMode(material) {
    return material.transparent ? kBlend : material.alphaTest > 0 ? kMask : kOpaque;
}

// Whether it is drawn in the picture of the surfaces that others are seen through.
export function isBlended(material) {
    return alphaMode(material) === kBlend || isGlass(material);
}

export function packMaterial(m, rows = new Float32Array(4 * kMaterialRows)) {
    const color = (c) => (c ? [c.r, c.g, c.b] : [1, 1, 1]);
    rows.set([...color(m.color), m.opacity ?? 1], 0);
    rows.set([0, 0, 0, m.normalScale?.x ?? 1], 4);
    rows.set([m.metalness ?? 1, m.roughness ?? 1, m.specularIntensity ?? 1, m.ior ?? 1.5], 8);
    rows.set([...color(m.specularColor), m.alphaTest ?? 0.5], 12);
    rows.set(
        [
            m.clearcoat ?? 0,
            m.clearcoatRoughness ?? 0,
            m.clearcoatNormalScale?.x ?? 1,
            isUnlit(m) ? 1 : 0,
        ],
        16,
    );
    // three.js draws what is seen through glass; the shaders leave out what is not reflected then.
    rows.set([isGlass(m) ? m.transmission : 0, 0, 0, 0, 1, 1, 1, 0], 20);
    kSlots.forEach(([, textureOf], i) => {
        const texture = textureOf(m);
        const at = 4 * (kFactorRows + 2 * i);
        if (texture?.matrixAutoUpdate) texture.updateMatrix();
        const t = texture?.matrix.elements ?? [1, 0, 0, 0, 1, 0, 0, 0, 1];
        rows.set([t[0], t[3], t[6], texture?.channel ?? 0, t[1], t[4], t[7], texture ? 1 : 0], at);
    });
    return rows;
}
