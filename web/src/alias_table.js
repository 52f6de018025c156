// Choice in proportion to given chances. twin: src/gl/alias_table.cpp.

// Walker's alias method: with column i chosen uniformly, i by thresholds[i], else aliases[i].
// source: Vose 1991, "A Linear Algorithm for Generating Random Numbers with a Given Distribution".
export function aliasTable(probabilities) {
    const scaled = probabilities.map((p) => p * probabilities.length),
        thresholds = probabilities.map(() => 1),
        aliases = probabilities.map((_, i) => i),
        small = [],
        large = [];
    scaled.forEach((p, i) => (p < 1 ? small : large).push(i));
    while (small.length > 0 && large.length > 0) {
        const low = small.pop(),
            high = large.at(-1);
        thresholds[low] = scaled[low];
        aliases[low] = high;
        scaled[high] -= 1 - scaled[low];
        if (scaled[high] < 1) small.push(large.pop());
    }
    return { thresholds, aliases };
}
