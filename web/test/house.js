// Two rooms with a door between them that a body passes, and a slit that it does not; three viewpoints, notes and material
// variants. As a .glb.
import { GlbBuilder } from './built_room.js';

// Metres, along the wall between the rooms.
export const door = { from: 0.6, to: 1.5 },
    slit = { from: -1.2, to: -0.8 };
const kHeight = 2.6,
    kDoorHeight = 2.1,
    kHalfWall = 0.05;

// The six sides of a box, seen from outside.
function boxOf([x0, y0, z0], [x1, y1, z1]) {
    const [x, y, z] = [x1 - x0, y1 - y0, z1 - z0];
    return [
        [[x0, y0, z0], [x, 0, 0], [0, 0, z]],
        [[x0, y1, z1], [x, 0, 0], [0, 0, -z]],
        [[x0, y0, z1], [x, 0, 0], [0, y, 0]],
        [[x1, y0, z0], [-x, 0, 0], [0, y, 0]],
        [[x0, y0, z0], [0, 0, z], [0, y, 0]],
        [[x1, y0, z1], [0, 0, -z], [0, y, 0]],
    ];
}

function addCamera(house, name, at, yaw, pitch) {
    const [cy, sy, cp, sp] = [Math.cos(yaw / 2), Math.sin(yaw / 2), Math.cos(pitch / 2), Math.sin(pitch / 2)];
    house.json.scenes[0].nodes.push(
        house.push('nodes', { name, camera: 0, translation: at, rotation: [cy * sp, sy * cp, -sy * sp, cy * cp] }),
    );
}

function addShell(house, material) {
    const [across, up, deep] = [[6, 0, 0], [0, kHeight, 0], [0, 0, 4]];
    house.add(material('white', [0.8, 0.8, 0.78], 1), [
        [[-3, kHeight, -2], across, deep],
        [[-3, 0, -2], across, up],
        [[3, 0, 2], [-6, 0, 0], up],
        [[-3, 0, 2], [0, 0, -4], up],
        [[3, 0, -2], deep, up],
    ]);
    const wall = (from, to, bottom = 0) => boxOf([-kHalfWall, bottom, from], [kHalfWall, kHeight, to]);
    house.add(material('partition', [0.4, 0.55, 0.7], 1), [
        ...wall(-2, slit.from),
        ...wall(slit.to, door.from),
        ...wall(door.to, 2),
        ...wall(slit.from, slit.to, kDoorHeight),
        ...wall(door.from, door.to, kDoorHeight),
    ]);
    const lamp = material('lamp', [0, 0, 0], 1, {
        emissiveFactor: [1, 0.95, 0.85],
        extensions: { KHR_materials_emissive_strength: { emissiveStrength: 12 } },
    });
    for (const x of [-2, 1]) house.add(lamp, [[[x, kHeight - 0.01, -0.5], [1, 0, 0], [0, 0, 1]]]);
}

// Materials of the last mesh by variants, by their numbers.
function addVariants(house, materials) {
    house.json.meshes.at(-1).primitives[0].extensions = {
        KHR_materials_variants: { mappings: materials.map((material, i) => ({ material, variants: [i] })) },
    };
}

export const notes = [
    { at: [-1.5, 0.8, 0], text: 'A table of oak', link: 'https://example.org/table' },
    { at: [-2.9, 1.5, 0], text: '<img src=x onerror=globalThis.hacked=1>', link: 'javascript:globalThis.hacked=1' },
    { at: [2.5, 1, -1], text: 'In the other room' },
];

export function houseGlb() {
    const house = new GlbBuilder();
    house.json.extensionsUsed = ['KHR_materials_emissive_strength', 'KHR_materials_variants'];
    const material = (name, color, roughnessFactor, more = {}) =>
        house.push('materials', {
            name,
            pbrMetallicRoughness: { baseColorFactor: [...color, 1], metallicFactor: 0, roughnessFactor },
            ...more,
        });
    addShell(house, material);
    house.add(material('floor', [0.45, 0.3, 0.18], 0.4), [[[-3, 0, 2], [6, 0, 0], [0, 0, -4]]]);
    addVariants(house, [
        house.json.materials.length - 1,
        material('tiles', [0.05, 0.25, 0.1], 0.15),
    ]);
    house.add(material('table', [0.5, 0.25, 0.1], 0.3), boxOf([-1.9, 0, -0.4], [-1.1, 0.75, 0.4]));
    addVariants(house, [house.json.materials.length - 1, material('lacquer', [0.7, 0.03, 0.02], 0.1)]);
    house.json.extensions = { KHR_materials_variants: { variants: [{ name: 'Oak' }, { name: 'Lacquer' }] } };
    house.push('cameras', { type: 'perspective', perspective: { yfov: 0.9, aspectRatio: 16 / 9, znear: 0.01 } });
    addCamera(house, 'Living room', [-2.6, 1.6, -1.6], Math.PI + 0.6, -0.25);
    addCamera(house, 'Window', [-2.6, 1.6, 1.6], -0.6, -0.25);
    addCamera(house, 'Kitchen', [2.4, 1.6, 1.5], 0.6, -0.2);
    for (const { at, text, link } of notes)
        house.json.scenes[0].nodes.push(
            house.push('nodes', { translation: at, extras: { phat: { hotspot: text, ...(link && { link }) } } }),
        );
    return house.glb();
}
