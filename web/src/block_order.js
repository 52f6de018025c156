// The order in which the light of an atlas's blocks is made anew, one sample a texel at a time.
// twin: src/core/dynamic/block_order.cpp, but that no block is checked first, since a lamp changes all light; and
// src/core/dynamic/view_test.cpp.

// Rounds of blocks outside the view count as so many: they still light what is visible.
const kUnseenCount = 4;
export const kSettledRounds = 128;

// Whether a view may show what lies within `radius` of `center` and faces about where `normal` does. `view`: see
// Passes.draw.
export function maySee({ clipFromWorld: m, eye, eyeAtInfinity }, { center, normal, radius }) {
    const along = (row) => m[row] * center[0] + m[4 + row] * center[1] + m[8 + row] * center[2] + m[12 + row],
        reach = (row) => radius * Math.hypot(m[row], m[4 + row], m[8 + row]),
        w = along(3);
    if (eyeAtInfinity) return [0, 1].every((row) => Math.abs(along(row)) < w + reach(row));
    if (w < -reach(3)) return false;
    if (normal.reduce((sum, n, i) => sum + n * (eye[i] - center[i]), 0) < -radius) return false;
    return [0, 1].every((row) => Math.abs(along(row)) < w + 2 * reach(row));
}

export class BlockOrder {
    // `places`: TexelPoints.blocks.
    constructor(places) {
        this.places = places;
        this.rounds = new Uint32Array(places.length);
        this.turns = 0;
        this.lastTurns = new Uint32Array(places.length);
        this.unsettled = places.length;
    }

    // All light may be another one from now on.
    noteChange() {
        this.rounds.fill(0);
        this.unsettled = this.places.length;
    }

    // The next `count` blocks, { block, rounds }, or fewer once settled; they count as made.
    next(count, view) {
        // Less the passes since its last turn, so that what begins anew again and again has turns, too.
        const age = (block) => (this.turns - this.lastTurns[block]) / this.places.length;
        const due = this.places.map(
                (place, block) => this.rounds[block] * (maySee(view, place) ? 1 : kUnseenCount) - age(block),
            ),
            order = [...due.keys()].filter((block) => this.rounds[block] < kSettledRounds);
        order.sort((a, b) => due[a] - due[b] || a - b);
        return order.slice(0, count).map((block) => {
            const rounds = this.rounds[block]++;
            if (this.rounds[block] === kSettledRounds) --this.unsettled;
            this.lastTurns[block] = ++this.turns;
            return { block, rounds };
        });
    }

    // Whether more rounds change nothing that could be seen.
    get isSettled() {
        return this.unsettled === 0;
    }
}
