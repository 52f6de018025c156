// Parts of pictures: what three.js's scissor lets change, and either side of the wipe.
import { Vector4 } from 'three';

// What a pixel needs of those beside it, in pixels: three.js's materials look at the next one (inject.js), and sums are pooled.
export const kNeighbor = 1,
    kReach = 3; // twin: kReach in shaders/pool.frag

// Of a picture, the part that three.js's scissor lets change, [x, y, width, height], or null for all of it. `corner`: of the
// picture in what is drawn to.
export function scissoredPart(renderer, [cornerX, cornerY]) {
    const target = renderer.getRenderTarget();
    if (!(target ? target.scissorTest : renderer.getScissorTest())) return null;
    const scissor = new Vector4();
    if (target) scissor.copy(target.scissor);
    else renderer.getScissor(scissor).multiplyScalar(renderer.getPixelRatio());
    return [scissor.x - cornerX, scissor.y - cornerY, scissor.z, scissor.w];
}

// The part of a view's picture with `margin` pixels around it, as far as there are any.
export function partAround({ part, width, height }, margin) {
    const [x, y, w, h] = part ?? [0, 0, width, height],
        [left, bottom] = [x, y].map((low) => Math.max(Math.floor(low) - margin, 0)),
        [right, top] = [Math.min(Math.ceil(x + w) + margin, width), Math.min(Math.ceil(y + h) + margin, height)];
    return [left, bottom, Math.max(right - left, 0), Math.max(top - bottom, 0)];
}

// What of it is left and right of the wipe, with what is shown there: direct, glossy and diffuse light.
export function wipedParts(view, margin, wipe) {
    const [left, bottom, width, height] = partAround(view, margin),
        end = left + width,
        middle = Math.min(Math.max(Math.round(wipe * view.width), left), end);
    return [
        { scissor: [left, bottom, middle - left, height], show: [1, 1, 1] },
        { scissor: [middle, bottom, end - middle, height], show: [1, 0, 0] },
    ].filter(({ scissor: [, , w, h] }) => w > 0 && h > 0);
}
