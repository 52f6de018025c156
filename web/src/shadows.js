// Shadow maps that reach as far as the scene does, from as near to its lights as its surfaces are.
import { Box3, DoubleSide, Matrix4, PCFShadowMap, Sphere, Triangle, Vector3 } from 'three';
import { isGlass } from './material.js';

// Fine enough that a shadow's border is as sharp as in `phat render`, where maps are of 2048.
const kShadowTexels = 1024,
    kSunTexels = 2048; // they are spread over all of the scene
const kShadowOffset = 0.01; // units of length (BakedLight.unitMeters)
// What is nearer to a light casts no shadow; twin: addViews in src/gl/shadow_maps.cpp
const kMinNearOverFar = 2e-4;
const kFaceCorner = Math.sqrt(3); // of a cube, over its side's distance

// What a parallel projection from `light` must span to have all of the box in it.
function fitParallel(camera, light, box) {
    const [from, to] = [light, light.target].map((o) => new Vector3().setFromMatrixPosition(o.matrixWorld)),
        viewFromWorld = new Matrix4().lookAt(from, to, camera.up).setPosition(from).invert();
    const { min, max } = box.clone().applyMatrix4(viewFromWorld);
    Object.assign(camera, { left: min.x, right: max.x, bottom: min.y, top: max.y, near: -max.z, far: -min.z });
}

// The least distance from `place` to the surfaces of `meshes`, if it is below `nearest`.
function nearestOf(place, meshes, nearest) {
    const triangle = new Triangle(),
        corners = [triangle.a, triangle.b, triangle.c],
        closest = new Vector3();
    for (const { geometry, matrixWorld } of meshes) {
        const { index, attributes } = geometry,
            count = (index ?? attributes.position).count;
        for (let first = 0; first + 2 < count; first += 3) {
            corners.forEach((corner, i) => {
                corner.fromBufferAttribute(attributes.position, index ? index.getX(first + i) : first + i);
                corner.applyMatrix4(matrixWorld);
            });
            nearest = Math.min(nearest, triangle.closestPointToPoint(place, closest).distanceTo(place));
        }
    }
    return nearest;
}

function prepareShadow(light, meshes, box, unitMeters) {
    const { shadow } = light,
        { center, radius } = box.getBoundingSphere(new Sphere());
    light.castShadow = true;
    shadow.mapSize.setScalar(light.isDirectionalLight ? kSunTexels : kShadowTexels);
    shadow.normalBias = kShadowOffset * unitMeters;
    if (light.isDirectionalLight) fitParallel(shadow.camera, light, box);
    else {
        const place = new Vector3().setFromMatrixPosition(light.matrixWorld),
            far = place.distanceTo(center) + radius;
        Object.assign(shadow.camera, {
            near: Math.max(nearestOf(place, meshes, far) / kFaceCorner, kMinNearOverFar * far),
            far,
        });
    }
    shadow.camera.updateProjectionMatrix();
}

// A surface is looked up in a shadow map a little before it, along its normal. Files may leave normals out: then they
// are those of the triangles.
function completeNormals(mesh) {
    const { geometry } = mesh;
    if (geometry.attributes.normal) return;
    mesh.geometry = geometry.index ? geometry.toNonIndexed() : geometry.clone();
    mesh.geometry.computeVertexNormals();
}

/** Makes the punctual lights of a scene throw the shadows that they have in the bake, and its meshes receive them. */
export function prepareLights(renderer, scene) {
    Object.assign(renderer.shadowMap, { enabled: true, type: PCFShadowMap, needsUpdate: true });
    scene.updateMatrixWorld(true);
    const meshes = [],
        lights = [];
    let unitMeters = 1;
    scene.traverse((object) => {
        unitMeters = object.userData.unitMeters ?? unitMeters;
        if (object.shadow) lights.push(object);
        if (!object.isMesh) return;
        const materials = [object.material].flat();
        // three.js knows no light through glass: better all of it than none.
        object.castShadow = !materials.some(isGlass);
        object.receiveShadow = true;
        completeNormals(object);
        // Of a surface with a front only, too, whichever way it looks: as in the bake.
        for (const material of materials) material.shadowSide ??= DoubleSide;
        if (object.castShadow) meshes.push(object);
    });
    const box = meshes.reduce((all, mesh) => all.expandByObject(mesh), new Box3());
    if (!box.isEmpty()) for (const light of lights) prepareShadow(light, meshes, box, unitMeters);
}
