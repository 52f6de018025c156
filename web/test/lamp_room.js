// A room with a lamp under the ceiling, one at a wall and one at a point, and with a metal plate in it, and maybe a box, as a
// .glb.
import { GlbBuilder } from './built_room.js';

const kBoxSize = [0.5, 0.7, 0.5];

// A node named 'box'.
function addBox(room, material, { at, turn = 0, movable, travels }) {
    const [x, y, z] = kBoxSize,
        [left, front] = [-x / 2, z / 2],
        [across, up, deep] = [[x, 0, 0], [0, y, 0], [0, 0, z]],
        back = [0, 0, -z];
    room.add(material, [
        [[left, 0, -front], across, deep], // the bottom, which faces down
        [[left, y, front], across, back],
        [[left, 0, front], across, up],
        [[-left, 0, -front], [-x, 0, 0], up],
        [[left, 0, -front], deep, up],
        [[-left, 0, front], back, up],
    ]);
    Object.assign(room.json.nodes.at(-1), {
        name: 'box',
        translation: at,
        rotation: [0, Math.sin(turn / 2), 0, Math.cos(turn / 2)],
        ...(movable && { extras: { phat: { movable } } }),
    });
    if (!travels) return;
    const times = room.accessor(new Float32Array([0, 1]), 'SCALAR', 1, { min: [0], max: [1] }),
        places = room.accessor(new Float32Array([...at, ...travels]), 'VEC3', 3);
    room.push('animations', {
        samplers: [{ input: times, output: places }],
        channels: [{ sampler: 0, target: { node: room.json.nodes.length - 1, path: 'translation' } }],
    });
}

// `ceiling`, `wall`, `point`: how bright each of those is that the room has; those of surfaces may be 0. `paint`: the colour
// of the left wall. `box`: where the middle of its bottom is, its turn around that, radians, whether it is movable, and
// where an animation of a second takes it.
export function lampRoom({ ceiling, wall, point, paint = [0.8, 0.15, 0.1], box }) {
    const room = new GlbBuilder();
    const shining = (name, rgb, emissiveStrength) =>
        room.material(name, [0, 0, 0], {
            emissiveFactor: emissiveStrength > 0 ? rgb : [0, 0, 0],
            extensions: { KHR_materials_emissive_strength: { emissiveStrength } },
        });
    const across = [3, 0, 0],
        up = [0, 2.5, 0],
        deep = [0, 0, 3],
        back = [0, 0, -3];
    room.add(room.material('white', [0.7, 0.7, 0.7]), [
        [[-1.5, 0, -1.5], deep, across],
        [[-1.5, 2.5, -1.5], across, deep],
        [[-1.5, 0, -1.5], across, up],
        [[1.5, 0, 1.5], [-3, 0, 0], up],
        [[1.5, 0, 1.5], up, back],
    ]);
    room.add(room.material('red', paint), [[[-1.5, 0, 1.5], back, up]]);
    room.add(room.material('plate', [0.9, 0.9, 0.9], {}, { metallicFactor: 1, roughnessFactor: 0.3 }), [
        [[-0.8, 0.3, -0.9], [0, 0, 1.2], [1.6, 0, 0]],
        [[-0.8, 0.3, -0.9], [1.6, 0, 0], [0, 0, 1.2]],
    ]);
    if (ceiling !== undefined)
        room.add(shining('ceiling', [1, 0.95, 0.9], ceiling), [[[-0.5, 2.49, -0.5], [1, 0, 0], [0, 0, 1]]]);
    if (wall !== undefined)
        room.add(shining('wall', [0.3, 0.5, 1], wall), [[[1.49, 1, -0.4], [0, 0, 0.8], [0, 0.8, 0]]]);
    if (box) addBox(room, room.material('box', [0.2, 0.6, 0.25]), box);
    room.push('cameras', { type: 'perspective', perspective: { yfov: 1, aspectRatio: 16 / 9, znear: 0.01 } });
    const tilt = -0.25;
    room.json.scenes[0].nodes.push(
        room.push('nodes', {
            camera: 0,
            translation: [0, 1.6, 1.4],
            rotation: [Math.sin(tilt / 2), 0, 0, Math.cos(tilt / 2)],
        }),
    );
    if (point) {
        room.json.extensionsUsed.push('KHR_lights_punctual');
        room.json.extensions = {
            KHR_lights_punctual: { lights: [{ name: 'point', type: 'point', color: [1, 0.9, 0.6], intensity: point }] },
        };
        room.json.scenes[0].nodes.push(
            room.push('nodes', {
                name: 'point',
                translation: [-0.9, 1.6, 0.9],
                extensions: { KHR_lights_punctual: { light: 0 } },
            }),
        );
    }
    return room.glb();
}
