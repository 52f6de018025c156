// What the passes that update light read, as numbers.
// twin: src/gl/light_update_pass.cpp.
import { half, luminance, unpackRgb9e5 } from './file.js';
import { hashOf } from './sample_numbers.js';

// The bake's irradiance, as if by so many samples; texel size over the distance of what is around: not known to the bake.
const kBakedSamples = 64,
    kBakedNearness = 0.125;

// Of a guide's 256 weights. twin: shaders/lib/guide_direction.glsl.
export function guideSumsOf(weights) {
    const sums = new Uint32Array(weights.length);
    let rows = 0,
        row = 0;
    weights.forEach((weight, cell) => {
        if (cell % 16 === 0) {
            rows += row;
            row = 0;
        }
        sums[cell] = ((rows << 16) | row) >>> 0;
        row += weight;
    });
    return sums;
}

// Four words a texel. `points`: TexelPoints. twin: shaders/lib/irradiance_estimate.glsl.
export function bakedEstimates(irradiance, points, isOfArea) {
    const words = new Uint32Array(4 * irradiance.length),
        floats = new Float32Array(words.buffer);
    irradiance.forEach((packed, i) => {
        if (!points.receives(i)) return;
        unpackRgb9e5(packed, floats, 4 * i);
        const statistic = isOfArea ? luminance(floats.subarray(4 * i, 4 * i + 3)) : kBakedNearness;
        words[4 * i + 3] = (half(kBakedSamples) | (half(statistic) << 16)) >>> 0;
    });
    return words;
}

// What a layout is of.
export const kRays = 0,
    kLights = 1;

// Of every sixteen rounds each takes a texel into another one of the 4x4 parts of the square; where in it, and where its
// neighbours are, is another one each time.
export function layoutOf(what, { block, rounds }) {
    let part = 0;
    for (let bit = 0; bit < 4; ++bit) part |= ((rounds >> bit) & 1) << (3 - bit);
    return ((part ^ (hashOf(what, block) & 15)) << 6) | (hashOf(what, block, rounds) & 63);
}
