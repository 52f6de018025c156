// Lamps that emit what a photometric file says (EXT_lights_ies), which WebGLRenderer has none of: point lights of the
// mean intensity over all directions, which our materials multiply by a table's value over that mean.
import { Color, DataTexture, FloatType, NearestFilter, PointLight, RGBAFormat, ShaderChunk } from 'three';
import { fail, kName, readPayload } from './file.js';
import { shaderLibrary } from './gl.js';
import { axesOf, webTexels } from './photometric_web.js';
import { kTableWidth } from './tables.js';

const kExtension = 'EXT_lights_ies';
// What a file may have, twin: kMaxVerticalSteps and kMaxHorizontalSteps in src/io/ies/ies_photometry.h.
const kMaxSteps = [360, 180];
// A lamp's number is told to the shader by its decay, which three.js hands over in whatever order it has its lights:
// n-th of these above 2, so little that 20 lamps change the light at 100 m by a ten thousandth.
const kDecayStep = 2 ** -20;
const kLampTexels = 3; // (direction, vertical steps), (horizontalZero, first texel), (horizontal steps)

const fragment = () => `
${shaderLibrary('lib/table.glsl')}
uniform highp sampler2D phatPhotometry;
vec4 photometryTexel(int index) {
    return texelFetch(phatPhotometry, tableTexel(index), 0);
}
${shaderLibrary('lib/photometry.glsl')}
float phatPhotometricFalloff(float decay, vec3 towardLight) {
    int first = ${kLampTexels} * (int((decay - 2.0) * ${1 / kDecayStep}.0 + 0.5) - 1);
    if (first < 0) return 1.0;
    vec4 direction = photometryTexel(first), zero = photometryTexel(first + 1);
    ivec2 steps = ivec2(direction.w, photometryTexel(first + 2).x);
    return photometricFalloff(PhotometricLamp(direction.xyz, zero.xyz, int(zero.w), steps),
                              -inverseTransformDirection(towardLight, viewMatrix));
}
`;
const kPointLightInfo = 'getPointLightInfo( pointLight, geometryPosition, directLight );';

// The lamps of all rooms, because a room's lamps light what stands in another one of the same scene, too.
const lamps = [],
    uniforms = { phatPhotometry: { value: null } };
let firstTexels = []; // of the lamps' webs

function rebuild() {
    uniforms.phatPhotometry.value?.dispose();
    uniforms.phatPhotometry.value = null;
    if (lamps.length === 0) return;
    const webs = [...new Set(lamps.map((lamp) => lamp.photometry))],
        texels = webs.map(webTexels),
        places = new Map();
    let end = kLampTexels * lamps.length;
    webs.forEach((web, i) => {
        places.set(web, end);
        end += texels[i].length / 4;
    });
    firstTexels = lamps.map((lamp) => places.get(lamp.photometry));
    const height = Math.ceil(end / kTableWidth),
        data = new Float32Array(4 * kTableWidth * height);
    webs.forEach((web, i) => data.set(texels[i], 4 * places.get(web)));
    const texture = new DataTexture(data, kTableWidth, height, RGBAFormat, FloatType);
    texture.minFilter = texture.magFilter = NearestFilter;
    texture.needsUpdate = true;
    uniforms.phatPhotometry.value = texture;
    lamps.forEach((lamp, i) => (lamp.decay = 2 + (i + 1) * kDecayStep));
}

/** Lets lamps that have moved shine where they point now. */
export function updatePhotometry() {
    const texture = uniforms.phatPhotometry.value;
    lamps.forEach((lamp, i) => {
        const { direction, horizontalZero } = axesOf(lamp),
            [vertical, horizontal] = lamp.photometry.steps,
            row = [...direction, vertical, ...horizontalZero, firstTexels[i], horizontal],
            at = 4 * kLampTexels * i,
            { data } = texture.image;
        if (row.every((x, k) => data[at + k] === Math.fround(x))) return;
        data.set(row, at);
        texture.needsUpdate = true;
    });
}

/** What tells shaders with photometry apart from those without. */
export const photometryKey = () => (lamps.length > 0 ? ' photometry' : '');

/** Lets a shader of three.js light by photometry. */
export function addPhotometry(shader) {
    if (lamps.length === 0) return;
    const name = 'lights_fragment_begin',
        text = shader.fragmentShader.replace(`#include <${name}>`, ShaderChunk[name]);
    if (!text.includes(kPointLightInfo)) {
        console.warn('lamps with photometry shine the same all around: this three.js lights otherwise');
        return;
    }
    const falloff = 'directLight.color *= phatPhotometricFalloff(pointLight.decay, directLight.direction);';
    Object.assign(shader.uniforms, uniforms);
    shader.fragmentShader = text
        .replace(kPointLightInfo, `${kPointLightInfo}\n${falloff}`)
        .replace('#include <common>', `#include <common>\n${fragment()}`);
}

const webs = new WeakMap(); // promises by their parsers and light profiles

// Intensities over their mean.
async function readWeb(parser, { peakCandela, solidAngle, steps, relative }) {
    const good = Array.isArray(steps) && steps.every((n, i) => Number.isInteger(n) && n >= 1 && n <= kMaxSteps[i]);
    if (!good || !(peakCandela > 0) || !(solidAngle > 0)) fail('a photometry is out of range');
    const mean = solidAngle / (4 * Math.PI),
        values = await readPayload(parser, relative, Float32Array, (steps[0] + 1) * steps[1], 'a photometry');
    return { steps, values: values.map((x) => x / mean), meanCandela: mean * peakCandela };
}

async function createLamp(parser, { light, color = [1, 1, 1], multiplier = 1 }, profile) {
    if (!webs.has(parser)) webs.set(parser, new Map());
    const known = webs.get(parser);
    if (!known.has(profile)) known.set(profile, readWeb(parser, profile));
    const photometry = await known.get(profile),
        lamp = new PointLight(new Color().fromArray(color.map((x) => Math.min(Math.max(x, 0), 1))));
    lamp.intensity = multiplier * photometry.meanCandela;
    lamp.name = parser.json.extensions[kExtension].lights[light].name ?? '';
    lamp.photometry = photometry;
    return lamp;
}

/** A promise of the lamp of a node, or null where it has none. */
export function photometricLight(parser, node) {
    const own = parser.json.nodes[node].extensions?.[kExtension],
        all = parser.json.extensions?.[kName]?.photometries ?? [],
        profile = all.find(({ light }) => light === own?.light);
    return profile ? createLamp(parser, own, profile) : null;
}

function lampsIn(root) {
    const found = [];
    root.traverse((object) => {
        if (object.photometry) found.push(object);
    });
    return found;
}

export function showPhotometry(root) {
    const found = lampsIn(root);
    lamps.push(...found);
    if (found.length > 0) rebuild();
}

export function hidePhotometry(root) {
    const found = new Set(lampsIn(root));
    if (found.size === 0) return;
    lamps.splice(0, lamps.length, ...lamps.filter((lamp) => !found.has(lamp)));
    rebuild();
}
