// A yard of rough and of smooth metal before a wall, a part of which is of metal, too, as a .glb, and a sky with a small sun, as an .hdr.
import { GlbBuilder } from './built_room.js';

export function skyYard() {
    const room = new GlbBuilder(),
        metal = (name, roughnessFactor) => room.material(name, [0.9, 0.8, 0.7], {}, { metallicFactor: 1, roughnessFactor });
    room.add(room.material('wall', [0.6, 0.5, 0.4]), [[[-4, 0, -3], [3, 0, 0], [0, 1, 0]]]);
    room.add(metal('sheet', 0.4), [[[-1, 0, -3], [5, 0, 0], [0, 1, 0]]]);
    room.add(metal('rough', 0.5), [[[-4, 0, 2], [4, 0, 0], [0, 0, -5]]]);
    room.add(metal('smooth', 0.15), [[[0, 0, 2], [4, 0, 0], [0, 0, -5]]]);
    room.push('cameras', { type: 'perspective', perspective: { yfov: 1, aspectRatio: 16 / 9, znear: 0.01 } });
    // Looks down by .2.
    room.json.scenes[0].nodes.push(
        room.push('nodes', { camera: 0, translation: [0, 1.2, 2], rotation: [-Math.sin(0.1), 0, 0, Math.cos(0.1)] }),
    );
    return room.glb();
}

const [kWidth, kHeight] = [64, 32];

export function sunnySky() {
    // RGBE: mantissas and an exponent, 128 that of 1/256.
    const sky = [60, 80, 128, 128],
        sun = [230, 220, 200, 137], // 512 times as bright as its mantissas
        pixels = Array.from({ length: kWidth * kHeight }, (_, i) =>
            i % kWidth === 18 && Math.floor(i / kWidth) === 10 ? sun : sky,
        );
    const head = `#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${kHeight} +X ${kWidth}\n`;
    return Buffer.concat([Buffer.from(head, 'latin1'), Buffer.from(pixels.flat())]);
}
