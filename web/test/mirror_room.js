// A room with a mirror for a wall, as a .glb: behind the eye are a pane that a picture cuts out, one that is half
// transparent, one of glass, a wall with pictures of colours and normals, a lamp that shines by one, and a light at a point.
import { GlbBuilder, png } from './built_room.js';

export function mirrorRoom() {
    const room = new GlbBuilder();
    const material = (baseColor, more = {}, factors = {}) =>
        room.push('materials', {
            pbrMetallicRoughness: {
                baseColorFactor: baseColor.length === 4 ? baseColor : [...baseColor, 1],
                metallicFactor: 0,
                roughnessFactor: 1,
                ...factors,
            },
            ...more,
        });
    const sampler = room.push('samplers', { magFilter: 9728, minFilter: 9728, wrapS: 10497, wrapT: 10497 });
    const texture = (pixels) =>
        room.push('textures', {
            source: room.push('images', { bufferView: room.view(png(pixels)), mimeType: 'image/png' }),
            sampler,
        });
    const cut = texture([
            [230, 60, 20, 255],
            [0, 0, 0, 0],
        ]),
        shining = texture([
            [255, 255, 255],
            [60, 60, 255],
        ]),
        striped = texture([
            [255, 200, 40],
            [30, 90, 40],
            [200, 200, 200],
        ]),
        turned = texture([
            [204, 178, 230],
            [60, 100, 230],
        ]);
    const pane = { alphaMode: 'MASK', doubleSided: true };
    room.json.extensionsUsed.push('KHR_lights_punctual');
    const white = material([0.8, 0.8, 0.8]),
        across = [4, 0, 0],
        up = [0, 3, 0],
        deep = [0, 0, 4];
    room.add(white, [
        [[-2, 0, -2], deep, across],
        [[-2, 3, -2], across, deep],
        [[-2, 0, 2], [0, 0, -4], up],
        [[2, 0, -2], deep, up],
    ]);
    const tiled = { normalTexture: { index: turned, scale: 0.8 } };
    room.add(material([1, 1, 1], tiled, { baseColorTexture: { index: striped } }), [[[2, 0, 2], [-4, 0, 0], up]]);
    room.add(material([0.9, 0.9, 0.9], {}, { metallicFactor: 1, roughnessFactor: 0.05 }), [
        [[-2, 0, -2], across, up],
    ]);
    room.add(material([1, 1, 1], pane, { baseColorTexture: { index: cut } }), [
        [[-1.5, 0.4, 1.4], [1.2, 0, 0], [0, 1.4, 0]],
    ]);
    room.add(material([0.1, 0.2, 0.9, 0.5], { ...pane, alphaMode: 'BLEND' }), [
        [[0.2, 0.4, 1.2], [1.2, 0, 0], [0, 1.4, 0]],
    ]);
    // Between the light and the right wall.
    const glass = { doubleSided: true, extensions: { KHR_materials_transmission: { transmissionFactor: 1 } } };
    room.add(material([1, 1, 1], glass, { roughnessFactor: 0 }), [[[1.6, 1.2, 1], [0, 0, 0.95], [0, 1.6, 0]]]);
    const lamp = {
        emissiveFactor: [1, 1, 1],
        emissiveTexture: { index: shining },
        extensions: { KHR_materials_emissive_strength: { emissiveStrength: 12 } },
    };
    room.add(material([0, 0, 0], lamp), [[[-0.8, 2.98, 0.2], [1.6, 0, 0], [0, 0, 0.8]]]);
    room.push('cameras', { type: 'perspective', perspective: { yfov: 1, aspectRatio: 16 / 9, znear: 0.01 } });
    room.json.scenes[0].nodes.push(room.push('nodes', { camera: 0, translation: [0, 1.4, 0.6] }));
    room.json.extensions = { KHR_lights_punctual: { lights: [{ type: 'point', intensity: 4 }] } };
    room.json.scenes[0].nodes.push(
        room.push('nodes', { translation: [1.2, 2, 1.6], extensions: { KHR_lights_punctual: { light: 0 } } }),
    );
    return room.glb();
}
