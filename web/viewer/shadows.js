// Shadow maps of the page's lights that reach as far as the room does, whatever its unit.
import { Matrix4, Vector3 } from 'three';

// Fine enough that a shadow's border is as sharp as in `phat render`, where maps are of 2048.
const kShadowTexels = 1024;
// In units of length (BakedLight.unitMeters).
const kShadowOffset = 0.01,
    kNear = 0.5;

// What a parallel projection from `light` must span to have all of the sphere in it.
function fitParallel(camera, light, sphere) {
    const from = new Vector3().setFromMatrixPosition(light.matrixWorld),
        to = new Vector3().setFromMatrixPosition(light.target.matrixWorld);
    const viewFromWorld = new Matrix4().lookAt(from, to, camera.up).transpose();
    const { x, y, z } = sphere.center.clone().sub(from).applyMatrix4(viewFromWorld),
        r = sphere.radius;
    Object.assign(camera, { left: x - r, right: x + r, bottom: y - r, top: y + r, near: -z - r, far: r - z });
}

// `sphere`: around the room. pre: world matrices are up to date.
export function prepareShadow(light, sphere, unitMeters) {
    const { shadow } = light;
    light.castShadow = true;
    shadow.mapSize.setScalar(kShadowTexels);
    shadow.normalBias = kShadowOffset * unitMeters;
    if (light.isDirectionalLight) fitParallel(shadow.camera, light, sphere);
    else {
        const position = new Vector3().setFromMatrixPosition(light.matrixWorld);
        shadow.camera.near = kNear * unitMeters;
        shadow.camera.far = Math.max(position.distanceTo(sphere.center) + sphere.radius, 2 * shadow.camera.near);
    }
    shadow.camera.updateProjectionMatrix();
}
