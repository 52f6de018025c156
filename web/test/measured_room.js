// A room with two lamps of photometric files (EXT_lights_ies), a box and a metal plate, as a .glb.
import { GlbBuilder } from './built_room.js';

// A file of LM-63 over a formula of vertical and horizontal degrees.
function photometricFile(vertical, horizontal, candela) {
    const lines = [
        'IESNA:LM-63-2002',
        '[TEST] a formula',
        'TILT=NONE',
        `1 -1 1 ${vertical.length} ${horizontal.length} 1 2 0 0 0`,
        '1 1 10',
        vertical.join(' '),
        horizontal.join(' '),
        ...horizontal.map((h) => vertical.map((v) => candela(v, h).toFixed(4)).join(' ')),
    ];
    return new TextEncoder().encode(lines.join('\r\n') + '\r\n');
}

const degrees = (end, step) => Array.from({ length: end / step + 1 }, (_, i) => i * step),
    cosine = (angle) => Math.cos((angle * Math.PI) / 180);

export function measuredRoom() {
    const room = new GlbBuilder();
    const across = [4, 0, 0],
        up = [0, 3, 0],
        deep = [0, 0, 4];
    room.add(room.material('white', [0.7, 0.7, 0.7]), [
        [[-2, 0, -2], deep, across],
        [[-2, 3, -2], across, deep],
        [[-2, 0, -2], across, up],
        [[2, 0, 2], [-4, 0, 0], up],
        [[-2, 0, 2], [0, 0, -4], up],
        [[2, 0, -2], deep, up],
    ]);
    room.add(room.material('box', [0.2, 0.4, 0.7]), [
        [[-0.9, 0, -0.4], [0.6, 0, 0], [0, 0.7, 0]],
        [[-0.3, 0, -0.4], [0, 0, -0.6], [0, 0.7, 0]],
        [[-0.3, 0, -1], [-0.6, 0, 0], [0, 0.7, 0]],
        [[-0.9, 0, -1], [0, 0, 0.6], [0, 0.7, 0]],
        [[-0.9, 0.7, -0.4], [0.6, 0, 0], [0, 0, -0.6]],
    ]);
    room.add(room.material('plate', [0.9, 0.8, 0.6], {}, { metallicFactor: 1, roughnessFactor: 0.1 }), [
        [[0.2, 0.02, -1.4], [0, 0, 1.6], [1.4, 0, 0]],
    ]);
    room.push('cameras', { type: 'perspective', perspective: { yfov: 1.1, aspectRatio: 16 / 9, znear: 0.01 } });
    room.json.scenes[0].nodes.push(room.push('nodes', { camera: 0, translation: [0, 1.5, 1.9] }));
    const washer = photometricFile(degrees(180, 2), degrees(360, 5), (v, h) =>
            v < 90 ? 30 * Math.sqrt(1 - cosine(v) ** 2) * cosine(v) * (0.5 + 0.5 * cosine(h - 50)) ** 2 : 0.5 * (1 - cosine(h) ** 2) * (v > 90),
        ),
        downlight = photometricFile(degrees(90, 1), [0], (v) => 25 * Math.max(cosine(v), 0) ** 12);
    room.json.extensionsUsed.push('EXT_lights_ies');
    room.json.extensions = {
        EXT_lights_ies: {
            lights: [washer, downlight].map((bytes) => ({
                bufferView: room.view(bytes),
                mimeType: 'application/x-ies-lm-63',
            })),
        },
    };
    const hang = (name, translation, tilt, extension) =>
        room.json.scenes[0].nodes.push(
            room.push('nodes', {
                name,
                translation,
                rotation: [-Math.sin(tilt / 2), 0, 0, Math.cos(tilt / 2)],
                extensions: { EXT_lights_ies: extension },
            }),
        );
    hang('washer', [0.1, 2.6, -0.6], Math.PI / 2, { light: 0, multiplier: 1.5, color: [1, 0.8, 0.6] });
    hang('downlight', [0.9, 2.7, 0.3], Math.PI / 2 - 0.3, { light: 1 });
    return room.glb();
}
