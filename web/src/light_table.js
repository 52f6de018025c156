// The punctual lights that shine where a room is, as shaders/lib/lights.glsl reads them, without shadow maps.
// twin: createLightTable in src/gl/shadow_maps.cpp.
import { Matrix4, Vector3 } from 'three';
import { axesOf, webTexels } from './photometric_web.js';

const kPoint = 0,
    kSpot = 1,
    kDirectional = 2;
const kLightWords = 20;
const kMinDistance = 1e-6; // units of length, against division by zero

function typeOf(light) {
    if (light.isPointLight) return kPoint;
    if (light.isSpotLight) return kSpot;
    return light.isDirectionalLight ? kDirectional : -1;
}

function setPhotometry(rows, at, light, rootFromWorld, firstTexel) {
    const { direction, horizontalZero } = axesOf(light),
        [vertical, horizontal] = light.photometry.steps;
    rows.set([...direction.transformDirection(rootFromWorld), vertical, horizontal], at + 8);
    rows.set([...horizontalZero.transformDirection(rootFromWorld), firstTexel], at + 16);
}

// Five rows of four floats a light, in the space of `root`, then the tables of photometries; lengths are `unitMeters` where
// they are about a metre.
export function lightTable(root, unitMeters) {
    let scene = root;
    while (scene.parent) scene = scene.parent;
    const lights = [];
    scene.traverseVisible((object) => {
        if (object.isLight && typeOf(object) >= 0 && object.intensity > 0) lights.push(object);
    });
    const rootFromWorld = new Matrix4().copy(root.matrixWorld).invert(),
        worldPerRoot = root.matrixWorld.getMaxScaleOnAxis(),
        webs = [...new Set(lights.flatMap(({ photometry }) => photometry ?? []))].map((web) => [web, webTexels(web)]),
        firstTexels = new Map();
    let end = kLightWords * lights.length;
    for (const [web, texels] of webs) {
        firstTexels.set(web, end / 4);
        end += texels.length;
    }
    const rows = new Float32Array(end);
    for (const [web, texels] of webs) rows.set(texels, 4 * firstTexels.get(web));
    const position = (object) => new Vector3().setFromMatrixPosition(object.matrixWorld).applyMatrix4(rootFromWorld);
    lights.forEach((light, i) => {
        const type = typeOf(light),
            at = kLightWords * i,
            from = position(light),
            direction = light.target ? position(light.target).sub(from).normalize() : new Vector3(),
            // An intensity is irradiance times a length squared.
            scale = light.intensity / (type === kDirectional ? 1 : worldPerRoot ** 2),
            cosine = (angle) => (type === kSpot ? Math.cos(angle) : 0);
        rows.set([...from, type], at);
        rows.set([...light.color.toArray().map((x) => scale * x), (light.distance ?? 0) / worldPerRoot], at + 4);
        rows.set([...direction, cosine(light.angle * (1 - light.penumbra))], at + 8);
        rows.set([cosine(light.angle), 0, 0, (kMinDistance * unitMeters) ** 2], at + 12);
        if (light.photometry) setPhotometry(rows, at, light, rootFromWorld, firstTexels.get(light.photometry));
    });
    return { rows, count: lights.length };
}
