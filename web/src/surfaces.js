// The baked surfaces as three.js loaded them, with their tilePatches in the atlas.
// twin: src/gl/scene_upload.cpp.
import { Matrix3, Matrix4, Vector3 } from 'three';
import { kNoChart } from './file.js';

// A corner is 22 floats and the two charts. twin: the inputs of shaders/surface.vert.
export const kVertexWords = 24;
export const kVertexLayout = [
    [3, 0],
    [3, 3],
    [4, 6],
    [2, 10],
    [2, 12],
    [4, 14],
    [2, 18],
    [2, 20],
]; // size, offset
export const kChartsOffset = 22;

// The mesh of every surface of the file, in its order. Throws if one is missing.
export function surfaceMeshes(gltf, description) {
    const meshes = new Map();
    gltf.scene.traverse((object) => {
        if (!object.isMesh) return;
        // A node with one primitive is a mesh itself; with more, a group of them.
        let of = object;
        while (of && gltf.parser.associations.get(of)?.nodes === undefined) of = of.parent;
        const node = gltf.parser.associations.get(of)?.nodes,
            primitive = gltf.parser.associations.get(object)?.primitives ?? 0;
        meshes.set(`${node} ${primitive}`, object);
    });
    return description.surfaces.map(({ node, primitive }) => {
        const mesh = meshes.get(`${node} ${primitive}`);
        if (!mesh) throw new Error('the baked light cannot be read: a surface is missing');
        return mesh;
    });
}

export function triangleCount(mesh) {
    return (mesh.geometry.index ?? mesh.geometry.attributes.position).count / 3;
}

function atlasUv(geometry, texCoord) {
    return geometry.attributes[`uv${texCoord}`] ?? geometry.attributes[`texcoord_${texCoord}`];
}

// The charts of a triangle's front and back, and where the other side's texels are relative to its own.
function sidesOf(atlas, own) {
    const chart = atlas.charts[own];
    if (!chart) return { charts: [kNoChart, kNoChart], front: [0, 0], back: [0, 0] };
    const other = atlas.charts[chart.otherSide];
    const offset = other
        ? [0, 1].map((axis) => 8 * (other.originTile[axis] - chart.originTile[axis]))
        : [0, 0];
    return {
        charts: chart.back ? [chart.otherSide, own] : [own, chart.otherSide],
        front: chart.back ? offset : [0, 0],
        back: chart.back ? [0, 0] : offset,
    };
}

// Normals and tangents that the file does not hold, as three.js would make them. Tangents in any case: a
// normal map may come later.
function completeGeometry(mesh) {
    let { geometry } = mesh;
    if (!geometry.attributes.normal) {
        geometry = geometry.index ? geometry.toNonIndexed() : geometry.clone();
        geometry.computeVertexNormals();
    }
    if (!geometry.attributes.tangent && geometry.attributes.uv) {
        geometry = geometry === mesh.geometry ? geometry.clone() : geometry;
        if (!geometry.index) geometry.setIndex([...Array(geometry.attributes.position.count).keys()]);
        geometry.computeTangents();
        // They point along v, which runs down in glTF, where green turns normals up.
        const { tangent } = geometry.attributes;
        for (let v = 0; v < tangent.count; ++v) tangent.setW(v, -tangent.getW(v));
    }
    return geometry;
}

function component(attribute, vertex, c, otherwise) {
    return attribute && c < attribute.itemSize ? attribute.getComponent(vertex, c) : otherwise;
}

// Writes the corners of a mesh in the space of the root, from word `at` of `floats` on.
function writeCorners(floats, at, geometry, rootFromMesh) {
    const { position, normal, tangent, uv, uv1, color } = geometry.attributes,
        normalMatrix = new Matrix3().getNormalMatrix(rootFromMesh),
        isMirrored = rootFromMesh.determinant() < 0,
        vector = new Vector3();
    for (let v = 0; v < position.count; ++v, at += kVertexWords) {
        vector.fromBufferAttribute(position, v).applyMatrix4(rootFromMesh).toArray(floats, at);
        vector
            .fromBufferAttribute(normal, v)
            .applyMatrix3(normalMatrix)
            .normalize()
            .toArray(floats, at + 3);
        if (tangent) {
            vector
                .fromBufferAttribute(tangent, v)
                .transformDirection(rootFromMesh)
                .toArray(floats, at + 6);
            floats[at + 9] = tangent.getW(v) * (isMirrored ? -1 : 1);
        }
        for (let c = 0; c < 2; ++c) {
            floats[at + 10 + c] = component(uv, v, c, 0);
            floats[at + 12 + c] = component(uv1, v, c, 0);
        }
        for (let c = 0; c < 4; ++c) floats[at + 14 + c] = component(color, v, c, 1);
    }
}

// Corners and triangles of all surfaces in the space of `root`, where the light was baked.
// Returns { vertices, indices, drawRanges: [{ mesh, first, count, firstVertex, rootFromMesh }] }.
export function gatherSurfaces(root, meshes, atlas, texCoord) {
    root.updateWorldMatrix(true, true);
    const rootFromWorld = new Matrix4().copy(root.matrixWorld).invert();
    const geometries = meshes.map(completeGeometry);
    const vertices = new Uint32Array(
        kVertexWords * geometries.reduce((sum, g) => sum + g.attributes.position.count, 0),
    );
    const indices = new Uint32Array(3 * meshes.reduce((sum, mesh) => sum + triangleCount(mesh), 0));
    const floats = new Float32Array(vertices.buffer);
    const drawRanges = [];
    let firstVertex = 0,
        first = 0;
    meshes.forEach((mesh, surface) => {
        const geometry = geometries[surface],
            uvAtlas = atlasUv(geometry, texCoord);
        if (!uvAtlas) throw new Error('the baked light cannot be read: the atlas UVs are missing');
        const rootFromMesh = new Matrix4().multiplyMatrices(rootFromWorld, mesh.matrixWorld),
            isMirrored = rootFromMesh.determinant() < 0;
        writeCorners(floats, kVertexWords * firstVertex, geometry, rootFromMesh);
        const count = triangleCount(mesh);
        for (let t = 0; t < count; ++t) {
            const sides = sidesOf(atlas, atlas.triangleChart[first / 3 + t]);
            for (let corner = 0; corner < 3; ++corner) {
                const v = geometry.index ? geometry.index.getX(3 * t + corner) : 3 * t + corner;
                const at = kVertexWords * (firstVertex + v);
                const texel = [uvAtlas.getX(v) * atlas.width, uvAtlas.getY(v) * atlas.height];
                for (let c = 0; c < 2; ++c) {
                    floats[at + 18 + c] = texel[c] + sides.front[c];
                    floats[at + 20 + c] = texel[c] + sides.back[c];
                    vertices[at + kChartsOffset + c] = sides.charts[c];
                }
                // Turned around where the node is mirrored, so that fronts stay counter-clockwise.
                indices[first + 3 * t + (isMirrored && corner > 0 ? 3 - corner : corner)] = firstVertex + v;
            }
        }
        drawRanges.push({ mesh, first, count: 3 * count, firstVertex, rootFromMesh });
        firstVertex += geometry.attributes.position.count;
        first += 3 * count;
    });
    return { vertices, indices, drawRanges };
}
