// Where the texels of the atlas are in the room, from which their rays begin.
// twin: src/core/atlas/texel_points.cpp, src/core/atlas/atlas_raster.h, src/gl/texel_points.cpp.
import { kNoChart, packDirection } from './file.js';
import { kVertexWords } from './surfaces.js';

const kGutterReach = 8; // texels
export const kBlockSize = 32;
export const kNoIrradiance = 0x80008000, // twin: shaders/lib/texel_point.glsl
    kCovered = 0x80008001;
const kNone = -1;

const minus = (a, b) => a.map((x, i) => x - b[i]);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
const unit = (v) => v.map((x) => x / Math.hypot(...v));

// A triangle in texels of its chart and in the room, and the affine map from one to the other.
class TexelTriangle {
    constructor({ indices }, floats, triangle, { back, originTile }) {
        const places = [0, 1, 2].map((i) => kVertexWords * indices[3 * triangle + i]),
            at = back ? 20 : 18;
        this.corner = places.map((p) => [0, 1].map((axis) => floats[p + at + axis] - 8 * originTile[axis]));
        this.position = places.map((p) => [...floats.subarray(p, p + 3)]);
        this.normals = places.map((p) => [...floats.subarray(p + 3, p + 6)]);
        this.e1 = minus(this.position[1], this.position[0]);
        this.e2 = minus(this.position[2], this.position[0]);
        const normal = unit(cross(this.e1, this.e2));
        this.faceNormal = Number.isFinite(normal[0]) ? normal : [0, 0, 1];
        const [[ax, ay], [bx, by]] = [1, 2].map((i) => minus(this.corner[i], this.corner[0])),
            determinant = ax * by - ay * bx;
        this.toFirst = [by / determinant, -bx / determinant];
        this.toSecond = [-ay / determinant, ax / determinant];
    }

    barycentricAt(x, y) {
        const [cx, cy] = this.corner[0],
            [dx, dy] = [x - cx, y - cy];
        return [
            this.toFirst[0] * dx + this.toFirst[1] * dy,
            this.toSecond[0] * dx + this.toSecond[1] * dy,
        ];
    }

    positionAt([s, t]) {
        const [a] = this.position,
            { e1, e2 } = this;
        return [a[0] + s * e1[0] + t * e2[0], a[1] + s * e1[1] + t * e2[1], a[2] + s * e1[2] + t * e2[2]];
    }

    texelAt([s, t]) {
        const [a, b, c] = this.corner;
        return [a[0] + s * (b[0] - a[0]) + t * (c[0] - a[0]), a[1] + s * (b[1] - a[1]) + t * (c[1] - a[1])];
    }

    // Of the triangle's point nearest to a texel's centre.
    nearestBarycentric(x, y) {
        const b = this.barycentricAt(x, y);
        if (b[0] >= 0 && b[1] >= 0 && b[0] + b[1] <= 1) return b;
        let best = Infinity,
            nearest = [0, 0];
        for (let i = 0; i < 3; ++i) {
            const from = this.corner[i],
                to = this.corner[(i + 1) % 3],
                [ex, ey] = [to[0] - from[0], to[1] - from[1]],
                [dx, dy] = [x - from[0], y - from[1]],
                along = Math.min(Math.max((dx * ex + dy * ey) / Math.max(ex * ex + ey * ey, 1e-300), 0), 1),
                off = (dx - along * ex) ** 2 + (dy - along * ey) ** 2;
            if (!(off < best)) continue;
            best = off;
            nearest = [
                [along, 0],
                [1 - along, along],
                [0, 1 - along],
            ][i];
        }
        return nearest;
    }

    normalAt([s, t]) {
        const [a, b, c] = this.normals,
            r = 1 - s - t,
            n = [0, 1, 2].map((i) => r * a[i] + s * b[i] + t * c[i]),
            length = Math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        // Vertex normals that point through the surface would turn the hemisphere of directions inside out.
        if (!(length > 1e-6 && length < Infinity) || !(dot(n, this.faceNormal) > 0)) return this.faceNormal;
        return n.map((x) => x / length);
    }

    // { position, normal } of a texel's centre, which may be outside.
    pointAt(x, y, texelMeters, isInside) {
        const b = this.barycentricAt(x, y);
        let position = this.positionAt(b);
        if (isInside) return { position, normal: this.normalAt(b) };
        const clamped = this.nearestBarycentric(x, y),
            distance = (p, q) => Math.hypot(...minus(p, q)),
            nearest = this.positionAt(clamped),
            reach = 2 * texelMeters * distance(this.texelAt(clamped), [x, y]);
        // Clamp: small triangles carry the rounding of their corners.
        if (!(distance(position, nearest) <= reach + 1e-4 * texelMeters)) position = nearest;
        return { position, normal: this.normalAt(clamped) };
    }
}

// Twice the signed area of (a, b, p), exactly antisymmetric in a and b.
function edgeFunction(a, b, x, y) {
    const isOrdered = a[0] < b[0] || (a[0] === b[0] && a[1] < b[1]),
        from = isOrdered ? a : b,
        to = isOrdered ? b : a,
        value = (to[0] - from[0]) * (y - from[1]) - (to[1] - from[1]) * (x - from[0]);
    return isOrdered ? value : -value;
}

// Calls visit(x, y) for every texel whose centre is inside a counter-clockwise triangle; by the top-left rule.
function forEachTexel(corner, width, height, visit) {
    if (!(edgeFunction(corner[0], corner[1], ...corner[2]) > 0)) return;
    const [low, high] = [Math.min, Math.max].map((of) => [0, 1].map((axis) => of(...corner.map((c) => c[axis]))));
    const isInside = (a, b, x, y) => {
        const side = edgeFunction(a, b, x, y);
        if (side !== 0) return side > 0;
        return b[1] < a[1] || (b[1] === a[1] && b[0] > a[0]);
    };
    const [a, b, c] = corner;
    const last = [width, height].map((size, axis) => Math.min(size - 1, Math.ceil(high[axis])));
    for (let y = Math.max(0, Math.floor(low[1] - 0.5)); y <= last[1]; ++y)
        for (let x = Math.max(0, Math.floor(low[0] - 0.5)); x <= last[0]; ++x)
            if (
                isInside(a, b, x + 0.5, y + 0.5) &&
                isInside(b, c, x + 0.5, y + 0.5) &&
                isInside(c, a, x + 0.5, y + 0.5)
            )
                visit(x, y);
}

// Which of its triangles each texel of a chart belongs to.
class Claims {
    // `triangles`: TexelTriangles.
    constructor({ sizeTiles }, triangles) {
        [this.width, this.height] = sizeTiles.map((tiles) => 8 * tiles);
        this.triangles = triangles;
        this.triangle = new Int32Array(this.width * this.height).fill(kNone);
        this.distance = new Float32Array(this.triangle.length).fill(Infinity); // texels; 0: the centre is inside
    }

    *settle() {
        yield* this.claimCentres();
        // A candidate travels one texel a round.
        for (let round = 0; round < kGutterReach + 2 && this.spread(); ++round) yield;
    }

    // A triangle around no centre claims the texel under its middle.
    *claimCentres() {
        const small = [];
        for (const [t, { corner }] of this.triangles.entries()) {
            let any = false;
            forEachTexel(corner, this.width, this.height, (x, y) => {
                const i = y * this.width + x;
                any = true;
                if (this.distance[i] === 0) return;
                this.triangle[i] = t;
                this.distance[i] = 0;
            });
            if (!any) small.push(t);
            yield;
        }
        for (const t of small) {
            const [x, y] = [0, 1].map((axis) =>
                Math.trunc(this.triangles[t].corner.reduce((sum, c) => sum + c[axis], 0) / 3),
            );
            if (x >= 0 && y >= 0 && x < this.width && y < this.height) this.offer(x, y, t);
        }
    }

    // Whether the triangle is nearer than what the texel has.
    offer(x, y, t) {
        const i = y * this.width + x;
        if (this.distance[i] === 0 || this.triangle[i] === t) return false;
        const triangle = this.triangles[t],
            nearest = triangle.texelAt(triangle.nearestBarycentric(x + 0.5, y + 0.5)),
            distance = Math.fround(Math.max(Math.hypot(nearest[0] - x - 0.5, nearest[1] - y - 0.5), 1e-6));
        const isNearer = distance < this.distance[i] || (distance === this.distance[i] && t < this.triangle[i]);
        if (!isNearer || distance > kGutterReach) return false;
        this.triangle[i] = t;
        this.distance[i] = distance;
        return true;
    }

    // Whether any texel has found another triangle.
    spread() {
        const before = this.triangle.slice(),
            { width, height, distance } = this;
        let any = false;
        for (let y = 0, i = 0; y < height; ++y)
            for (let x = 0; x < width; ++x, ++i) {
                if (distance[i] === 0) continue;
                for (let ny = Math.max(0, y - 1); ny <= Math.min(height - 1, y + 1); ++ny)
                    for (let nx = Math.max(0, x - 1); nx <= Math.min(width - 1, x + 1); ++nx) {
                        const candidate = before[ny * width + nx];
                        if (candidate !== kNone && this.offer(x, y, candidate)) any = true;
                    }
            }
        return any;
    }
}

// The rectangles of a chart's blocks, in their order: { origin, size }, texels. twin: src/core/atlas/atlas_blocks.cpp.
export function blockRects({ originTile, sizeTiles }) {
    const rects = [];
    for (let y = 0; y < sizeTiles[1]; y += 4)
        for (let x = 0; x < sizeTiles[0]; x += 4)
            rects.push({
                origin: [8 * (originTile[0] + x), 8 * (originTile[1] + y)],
                size: [Math.min(kBlockSize, 8 * (sizeTiles[0] - x)), Math.min(kBlockSize, 8 * (sizeTiles[1] - y))],
            });
    return rects;
}

// Bounds and mean normal of a block's texels.
class BlockSums {
    constructor(rect) {
        Object.assign(this, rect, { low: [0, 0, 0].fill(Infinity), high: [0, 0, 0].fill(-Infinity), sum: [0, 0, 0] });
    }

    addNormal(normal) {
        for (let axis = 0; axis < 3; ++axis) this.sum[axis] += normal[axis];
    }

    addPosition(position) {
        for (let axis = 0; axis < 3; ++axis) {
            this.low[axis] = Math.min(this.low[axis], position[axis]);
            this.high[axis] = Math.max(this.high[axis], position[axis]);
        }
    }

    // { origin, size, center, normal, radius }
    place() {
        const { origin, size, low, high, sum } = this,
            isEmpty = low[0] > high[0],
            length = Math.hypot(...sum);
        return {
            origin,
            size,
            center: low.map((x, i) => (isEmpty ? 0 : 0.5 * (x + high[i]))),
            normal: sum.map((x, i) => (length > 1e-9 ? x / length : i === 2 ? 1 : 0)),
            radius: isEmpty ? 0 : 0.5 * Math.hypot(...minus(high, low)),
        };
    }
}

// [y][x] of the atlas: `places`, four words a texel: the position, NaN where there is none, and the flat normal;
// `normals`, as if nothing covered what the bake found on a surface; and what is known of the blocks.
export class TexelPoints {
    // `covered`: bits, see docs/format.md.
    constructor(atlas, covered) {
        const texels = atlas.width * atlas.height;
        Object.assign(this, { atlas, covered });
        this.places = new Uint32Array(4 * texels).fill(0x7fc00000);
        this.positions = new Float32Array(this.places.buffer);
        this.normals = new Uint32Array(texels);
        this.blocks = atlas.charts.flatMap((chart) => blockRects(chart).map((rect) => new BlockSums(rect)));
    }

    isCovered(texel) {
        return ((this.covered[texel >> 3] >> (texel & 7)) & 1) !== 0;
    }

    // Writes the texels of `chart`, which has those triangles or is the other side of one that has.
    *fill(chart, claims) {
        const [left, top] = chart.originTile.map((tile) => 8 * tile),
            texelOf = (i) => (top + Math.floor(i / claims.width)) * this.atlas.width + left + (i % claims.width);
        // Where nothing but gutters is to be seen, these have irradiance of their own.
        const hasSurface = claims.distance.some((d, i) => d === 0 && !this.isCovered(texelOf(i))),
            side = chart.back ? -1 : 1;
        for (const [i, t] of claims.triangle.entries()) {
            if (i % claims.width === 0) yield;
            if (t === kNone) continue;
            const [x, y] = [i % claims.width, Math.floor(i / claims.width)],
                triangle = claims.triangles[t],
                isInside = claims.distance[i] === 0,
                { position, normal } = triangle.pointAt(x + 0.5, y + 0.5, chart.texelSizeMeters, isInside),
                texel = texelOf(i),
                turned = normal.map((c) => side * c);
            const block = this.blocks[chart.firstBlock + (y >> 5) * chart.blocksWide + (x >> 5)];
            block.addNormal(turned);
            // What is covered on a surface may be uncovered when something moves; gutters are not worth it.
            if (this.isCovered(texel) && !isInside) continue;
            block.addPosition(position);
            this.positions.set(position, 4 * texel);
            this.places[4 * texel + 3] = packDirection(triangle.faceNormal.map((c) => side * c));
            const receives = isInside || !hasSurface;
            this.normals[texel] = receives ? packDirection(turned) : kNoIrradiance;
        }
    }

    // At rest.
    receives(texel) {
        return !this.isCovered(texel) && !Number.isNaN(this.positions[4 * texel]) && this.normals[texel] !== kNoIrradiance;
    }
}

// `normals` at rest, as shaders/lib/texel_point.glsl reads them.
export function shownNormals(points) {
    return points.normals.map((normal, texel) => (points.isCovered(texel) ? kCovered : normal));
}

function trianglesByChart({ charts, triangleChart }) {
    const lists = charts.map(() => []);
    triangleChart.forEach((chart, triangle) => {
        if (chart !== kNoChart) lists[chart].push(triangle);
    });
    return lists;
}

// The points of all texels, in small steps, between which pages may draw. Returns TexelPoints.
export function* findTexelPoints(surfaces, atlas, covered) {
    const points = new TexelPoints(atlas, covered),
        floats = new Float32Array(surfaces.vertices.buffer);
    for (const [c, triangles] of trianglesByChart(atlas).entries()) {
        if (triangles.length === 0) continue; // it is filled with its other side
        const chart = atlas.charts[c],
            other = atlas.charts[chart.otherSide],
            claims = new Claims(
                chart,
                triangles.map((t) => new TexelTriangle(surfaces, floats, t, chart)),
            );
        yield* claims.settle();
        yield* points.fill(chart, claims);
        if (other) yield* points.fill(other, claims);
    }
    points.blocks = points.blocks.map((block) => block.place());
    return points;
}
