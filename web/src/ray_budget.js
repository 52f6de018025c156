// How many rays a picture may trace, from how long those of others took.

// Levels: 0 traces none, each other one twice as many as the one before.
export const kMaxLevel = 4;
// twin: RayBudget in src/gl/renderer.h, at the highest level.
export function raysOf(level) {
    return { raysPerNeighborhood: 1.5 * 2 ** level, maxRays: 2 ** (level - 1), lightSamples: 1 };
}

// More rays are traced only where they would fit so many times, so that pictures do not alternate.
const kReserve = 1.5;

// The level whose rays are traced in `milliseconds`. `cost`: milliseconds that level 1 takes for a pixel; `last`: the level
// of the picture before.
export function levelFor({ cost, pixels, milliseconds, last }) {
    const fitting = (reserve) => {
        const times = milliseconds / (reserve * cost * pixels);
        return times >= 1 ? Math.min(kMaxLevel, 1 + Math.floor(Math.log2(times))) : 0;
    };
    const level = fitting(1);
    return level > last ? Math.max(last, fitting(kReserve)) : level;
}

// Slower pictures count at once, faster ones bit by bit: a single fast one may have been of the ceiling.
const kTrust = 0.25;
// Where nothing is traced, what is known gets old: after some hundred pictures rays have another chance.
const kForgotten = 0.995;

// What is known of the cost after a picture of a level, which took `milliseconds` of rays or, at level 0, was not measured.
export function costAfter(cost, { level, pixels, milliseconds }) {
    if (level === 0) return kForgotten * cost;
    const measured = milliseconds / (pixels * 2 ** (level - 1));
    return measured > cost ? measured : cost + kTrust * (measured - cost);
}

// Before any ray has been traced: rays of level 1 against the lookup of a pixel at quality 'fast'. A guess, which the
// first pictures replace.
const kRaysOverLookup = 2;
export function costFromLookup({ pixels, milliseconds, relativeCost }) {
    return (kRaysOverLookup * milliseconds) / (relativeCost * pixels);
}
