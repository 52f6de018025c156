// Blocks of the atlas whose light is made anew, side by side in the targets of passes.
// twin: src/gl/texel_batch.h, where less may be kept; shaders/lib/texel_batch.glsl.
import { kBlockSize } from './texel_points.js';

const kBatchSide = 8;
export const kBatchBlocks = kBatchSide * kBatchSide;

// The side of a target with so many texels a block and side.
export function batchTarget(texels) {
    return kBatchSide * texels;
}

// The part of it that so many blocks take.
export function batchSize(blocks, texels) {
    return [kBatchSide * texels, Math.ceil(blocks / kBatchSide) * texels];
}

// Where the i-th block is in it.
export function batchCorner(i, texels) {
    return [(i % kBatchSide) * texels, Math.floor(i / kBatchSide) * texels];
}

// What was known before counts as so many samples: as one at first, because a lamp changes all light; few for as long as
// the change spreads from bounce to bounce, and then ever more.
function maxSamples(rounds) {
    const kMin = 4,
        kSpreading = 32;
    return Math.max(Math.min(rounds, kMin), 1) + Math.floor((Math.max(rounds, kSpreading) - kSpreading) / 4);
}

export class TexelBatch {
    // `rects`: of all blocks, { origin, size }; `blocks`: of BlockOrder.next, at most kBatchBlocks.
    constructor(gl, rects, blocks) {
        Object.assign(this, { gl, rects, blocks });
    }

    // `scrambleOf(turn)`: the layout of a block's samples, see stratifiedSquare in shaders/lib/block_layout.glsl.
    set(program, scrambleOf) {
        const entries = new Uint32Array(4 * kBatchBlocks);
        this.blocks.forEach((turn, i) => {
            const { origin, size } = this.rects[turn.block],
                samples = (maxSamples(turn.rounds) << 16) | scrambleOf(turn);
            entries.set([(origin[1] << 16) | origin[0], (size[1] << 16) | size[0], turn.block, samples], 4 * i);
        });
        program.set('batchBlocks', entries);
    }

    get size() {
        return batchSize(this.blocks.length, kBlockSize);
    }

    // Those of the blocks for whose turns `isPart` holds.
    part(isPart) {
        return new TexelBatch(this.gl, this.rects, this.blocks.filter(isPart));
    }

    // What was drawn for each block's texels to its place in a texture.
    copyWords(target, to) {
        const { gl } = this;
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, target);
        gl.readBuffer(gl.COLOR_ATTACHMENT0);
        gl.bindTexture(gl.TEXTURE_2D, to);
        this.blocks.forEach(({ block }, i) => {
            const { origin, size } = this.rects[block];
            gl.copyTexSubImage2D(gl.TEXTURE_2D, 0, ...origin, ...batchCorner(i, kBlockSize), ...size);
        });
    }

    // What was drawn for each block's texels, attachment `from` of a target, to its place in a layer of an array.
    copyTexels(target, from, to, layer) {
        const { gl } = this;
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, target);
        gl.readBuffer(gl.COLOR_ATTACHMENT0 + from);
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, to);
        this.blocks.forEach(({ block }, i) => {
            const { origin, size } = this.rects[block];
            gl.copyTexSubImage3D(gl.TEXTURE_2D_ARRAY, 0, ...origin, layer, ...batchCorner(i, kBlockSize), ...size);
        });
    }
}
