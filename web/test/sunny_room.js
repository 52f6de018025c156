// A room with a window that the sun shines through, a pendant lamp within a shade and a spot lamp, as a .glb.
import { GlbBuilder } from './built_room.js';

// A square tube around (x, z), whose sides look outward: a light in it sees their backs alone.
function tube([x, z], radius, bottom, top) {
    const height = [0, top - bottom, 0],
        side = 2 * radius;
    return [
        [[x - radius, bottom, z + radius], [side, 0, 0], height],
        [[x + radius, bottom, z + radius], [0, 0, -side], height],
        [[x + radius, bottom, z - radius], [-side, 0, 0], height],
        [[x - radius, bottom, z - radius], [0, 0, side], height],
    ];
}

export function sunnyRoom() {
    const room = new GlbBuilder();
    const dull = { extensions: { KHR_materials_specular: { specularFactor: 0 } } },
        material = (name, baseColor) => room.material(name, baseColor, dull);
    const across = [4, 0, 0],
        up = [0, 3, 0],
        deep = [0, 0, 4];
    // The right wall, or what is outside of it, around a window of 1.2 by 1.2 metres.
    const around = (x, low, high, end) => [
        [[x, low, -end], [0, 0, 2 * end], [0, 0.9 - low, 0]],
        [[x, 2.1, -end], [0, 0, 2 * end], [0, high - 2.1, 0]],
        [[x, 0.9, -end], [0, 0, end - 0.6], [0, 1.2, 0]],
        [[x, 0.9, 0.6], [0, 0, end - 0.6], [0, 1.2, 0]],
    ];
    const kThickness = 0.3,
        [low, high, end] = [-kThickness, 3 + kThickness, 2 + kThickness],
        wide = [2 * end, 0, 0],
        tall = [0, high - low, 0],
        far = [0, 0, 2 * end];
    room.add(material('white', [0.7, 0.7, 0.7]), [
        [[-2, 0, -2], deep, across],
        [[-2, 3, -2], across, deep],
        [[-2, 0, -2], across, up],
        [[2, 0, 2], [-4, 0, 0], up],
        [[-2, 0, 2], [0, 0, -4], up],
        ...around(2, 0, 3, 2),
    ]);
    // Without it the sun would come in where walls meet, by a shadow map's texel.
    room.add(material('outside', [0.5, 0.5, 0.5]), [
        [[-end, low, -end], wide, far],
        [[-end, high, -end], far, wide],
        [[-end, low, -end], tall, wide],
        [[-end, low, end], wide, tall],
        [[-end, low, -end], far, tall],
        ...around(end, low, high, end).map(([corner, u, v]) => [corner, v, u]),
    ]);
    room.add(material('shade', [0.6, 0.3, 0.2]), tube([-0.8, -0.8], 0.1, 1.75, 2.05));
    room.add(material('box', [0.2, 0.4, 0.7]), [
        ...tube([-0.3, -0.7], 0.3, 0, 0.7),
        [[-0.6, 0.7, -0.4], [0.6, 0, 0], [0, 0, -0.6]],
    ]);
    room.push('cameras', { type: 'perspective', perspective: { yfov: 1.1, aspectRatio: 16 / 9, znear: 0.01 } });
    room.json.scenes[0].nodes.push(room.push('nodes', { camera: 0, translation: [0, 1.5, 1.9] }));
    room.json.extensionsUsed.push('KHR_lights_punctual', 'KHR_materials_specular');
    const lights = [];
    const shine = (light, translation, rotation) => {
        room.json.scenes[0].nodes.push(
            room.push('nodes', {
                name: light.name,
                translation,
                rotation,
                extensions: { KHR_lights_punctual: { light: lights.push(light) - 1 } },
            }),
        );
    };
    // About x, then y.
    const turned = (y, x) => {
        const [sy, cy, sx, cx] = [Math.sin(y / 2), Math.cos(y / 2), Math.sin(x / 2), Math.cos(x / 2)];
        return [cy * sx, sy * cx, -sy * sx, cy * cx];
    };
    shine({ name: 'sun', type: 'directional', color: [1, 0.9, 0.8], intensity: 3 }, [0, 1.5, 0], turned(0.9, -0.7));
    shine({ name: 'pendant', type: 'point', intensity: 3 }, [-0.8, 1.9, -0.8], [0, 0, 0, 1]);
    const cones = { innerConeAngle: 0.3, outerConeAngle: 0.45 };
    shine({ name: 'spot', type: 'spot', intensity: 8, spot: cones }, [1.2, 2.9, 0.6], turned(0.3, -1.1));
    room.json.extensions = { KHR_lights_punctual: { lights } };
    return room.glb();
}
