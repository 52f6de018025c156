// What a lamp with photometry has in the tables that shaders read, and how it is turned.
import { Vector3 } from 'three';

// The cells of a web's grid, a texel each. twin: addPhotometry in src/gl/shadow_maps.cpp.
function texelsOf({ steps: [rows, columns], values }) {
    const texels = new Float32Array(4 * rows * columns),
        point = (h, v) => values[(h % columns) * (rows + 1) + v];
    for (let h = 0, at = 0; h < columns; ++h)
        for (let v = 0; v < rows; ++v, at += 4)
            texels.set([point(h, v), point(h, v + 1), point(h + 1, v), point(h + 1, v + 1)], at);
    return texels;
}

const allTexels = new WeakMap(); // by their webs

export function webTexels(web) {
    if (!allTexels.has(web)) allTexels.set(web, texelsOf(web));
    return allTexels.get(web);
}

// Where the vertical and the horizontal angle of a lamp are 0, in the world.
export function axesOf(light) {
    const [x, y, z] = [new Vector3(), new Vector3(), new Vector3()];
    light.matrixWorld.extractBasis(x, y, z);
    const direction = z.normalize().negate();
    return { direction, horizontalZero: x.addScaledVector(direction, -x.dot(direction)).normalize() };
}
