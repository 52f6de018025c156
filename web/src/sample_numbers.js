// The numbers that the lookup and reflection rays sample directions with.
// twin: src/core/base/sobol.cpp, src/gl/sample_numbers.cpp.

const kRanks = 16,
    kMaxSamples = 32,
    kPlaces = 13; // twin: shaders/lib/sample_numbers.glsl

// A primitive polynomial over GF(2) of degree s with inner coefficients a, and the first numbers m.
function directionNumbers(s, a, m) {
    const v = new Uint32Array(32);
    for (let i = 0; i < 32; ++i) {
        if (s === 0) v[i] = 1 << (31 - i);
        else if (i < s) v[i] = m[i] << (31 - i);
        else {
            v[i] = v[i - s] ^ (v[i - s] >>> s);
            for (let k = 1; k < s; ++k) if ((a >> (s - 1 - k)) & 1) v[i] ^= v[i - k];
        }
    }
    return v;
}
const directions = [
    directionNumbers(0, 0, []),
    directionNumbers(1, 0, [1]),
    directionNumbers(2, 1, [1, 3]),
    directionNumbers(3, 1, [1, 3, 1]),
];

// Sobol's point as fractions of 2^32.
export function sobolBits(index) {
    return directions.map((v) => {
        let x = 0;
        for (let bit = 0; index >>> bit; ++bit) if ((index >>> bit) & 1) x ^= v[bit];
        return x >>> 0;
    });
}

// twin: hashOf in src/core/base/random.h, of numbers below 2^32; the lower half.
export function hashOf(a, b, c = 0) {
    const mask = (1n << 64n) - 1n;
    const mixBits = (x) => {
        x = ((x ^ (x >> 30n)) * 0xbf58476d1ce4e5b9n) & mask;
        x = ((x ^ (x >> 27n)) * 0x94d049bb133111ebn) & mask;
        return x ^ (x >> 31n);
    };
    const first = mixBits((BigInt(a) + 0x9e3779b97f4a7c15n) & mask);
    const second = mixBits((first + BigInt(b)) & mask);
    return Number(mixBits((second + BigInt(c)) & mask) & 0xffffffffn);
}

// Sobol's points, of which every rank has an aligned run; each seed shifts them all.
export function sampleNumberTables(sampleCount, seed) {
    // Bayer's order: neighbouring pixels take samples that are far apart.
    const bayer = [0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5];
    const run = 2 ** Math.ceil(Math.log2(sampleCount));
    const ranks = new Uint32Array(4 * kRanks),
        sampleNumbers = new Uint32Array(4 * kMaxSamples);
    bayer.forEach((order, rank) => ranks.set(sobolBits(run * order), 4 * rank));
    const shift = [0, 1, 2, 3].map((d) => hashOf(seed, d));
    for (let k = 0; k < kMaxSamples; ++k)
        sampleNumbers.set(
            sobolBits(k).map((bits, d) => bits ^ shift[d]),
            4 * k,
        );
    return { sampleNumbers, ranks };
}

// Of the sequence's points 1, 2, 4 ..., for pixels that take different numbers of samples.
export function placeNumbers() {
    const numbers = new Uint32Array(4 * kPlaces);
    for (let i = 0; i < kPlaces; ++i) numbers.set(sobolBits(1 << i), 4 * i);
    return numbers;
}

/** Position of picture `index` of `count` inside the pixel. */ // twin: jitterOf in src/gl/camera_matrices.cpp.
export function jitterOf(index, count) {
    if (count === 1) return [0, 0];
    const [x, y] = sobolBits(index);
    const fract = (t) => t - Math.floor(t);
    return [x, y].map((bits) => fract((bits >>> 16) / 65536 + 0.5 + 0.5 / count) - 0.5);
}
