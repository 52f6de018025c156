// A room with two panes, as a .glb: left one that a texture makes opaque on its right half, right a rough one.
import { deflateSync } from 'node:zlib';

// A picture of pixels [r, g, b], or [r, g, b, a], in one row.
export function png(pixels) {
    const crcTable = Array.from({ length: 256 }, (_, n) => {
        for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
        return n >>> 0;
    });
    const crc = (bytes) => {
        let c = 0xffffffff;
        for (const byte of bytes) c = crcTable[(c ^ byte) & 255] ^ (c >>> 8);
        return (c ^ 0xffffffff) >>> 0;
    };
    const word = (value) => {
        const bytes = Buffer.alloc(4);
        bytes.writeUInt32BE(value);
        return bytes;
    };
    const chunk = (type, data) => {
        const body = Buffer.concat([Buffer.from(type, 'latin1'), data]);
        return Buffer.concat([word(data.length), body, word(crc(body))]);
    };
    const header = Buffer.concat([word(pixels.length), word(1), Buffer.from([8, pixels[0].length === 4 ? 6 : 2, 0, 0, 0])]);
    return Buffer.concat([
        Buffer.from('\x89PNG\r\n\x1a\n', 'latin1'),
        chunk('IHDR', header),
        chunk('IDAT', deflateSync(Buffer.from([0, ...pixels.flat()]))),
        chunk('IEND', Buffer.alloc(0)),
    ]);
}

export class GlbBuilder {
    constructor() {
        this.bytes = [];
        this.length = 0;
        this.json = {
            asset: { version: '2.0' },
            extensionsUsed: ['KHR_materials_transmission', 'KHR_materials_emissive_strength'],
            scene: 0,
            scenes: [{ nodes: [] }],
            nodes: [],
            meshes: [],
            materials: [],
            accessors: [],
            bufferViews: [],
        };
    }

    push(section, value) {
        return (this.json[section] ??= []).push(value) - 1;
    }

    view(data) {
        const bytes = Buffer.from(data.buffer, data.byteOffset, data.byteLength);
        const padded = Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);
        const index = this.push('bufferViews', {
            buffer: 0,
            byteOffset: this.length,
            byteLength: bytes.length,
        });
        this.bytes.push(padded);
        this.length += padded.length;
        return index;
    }

    accessor(data, type, size, more = {}) {
        const componentType = data instanceof Float32Array ? 5126 : 5123;
        const bufferView = this.view(data);
        return this.push('accessors', {
            bufferView,
            componentType,
            type,
            count: data.length / size,
            ...more,
        });
    }

    // Rough, and no metal, but for `factors` of pbrMetallicRoughness.
    material(name, baseColor, more = {}, factors = {}) {
        return this.push('materials', {
            name,
            pbrMetallicRoughness: {
                baseColorFactor: [...baseColor, 1],
                metallicFactor: 0,
                roughnessFactor: 1,
                ...factors,
            },
            ...more,
        });
    }

    // `quads`: [corner, side, side], which is counter-clockwise.
    add(material, quads) {
        const positions = quads.flatMap(([corner, u, v]) =>
            [
                [0, 0],
                [1, 0],
                [1, 1],
                [0, 1],
            ].map(([s, t]) => corner.map((x, i) => x + s * u[i] + t * v[i])),
        );
        const extreme = (of) => [0, 1, 2].map((i) => Math.fround(of(...positions.map((p) => p[i]))));
        const attributes = {
            POSITION: this.accessor(new Float32Array(positions.flat()), 'VEC3', 3, {
                min: extreme(Math.min),
                max: extreme(Math.max),
            }),
            TEXCOORD_0: this.accessor(
                new Float32Array(quads.flatMap(() => [0, 0, 1, 0, 1, 1, 0, 1])),
                'VEC2',
                2,
            ),
        };
        const indices = this.accessor(
            new Uint16Array(quads.flatMap((_, i) => [0, 1, 2, 0, 2, 3].map((v) => 4 * i + v))),
            'SCALAR',
            1,
        );
        const mesh = this.push('meshes', { primitives: [{ attributes, indices, material }] });
        this.json.scenes[0].nodes.push(this.push('nodes', { mesh }));
    }

    glb() {
        this.json.buffers = [{ byteLength: this.length }];
        const text = Buffer.from(JSON.stringify(this.json));
        const json = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
        const words = (...values) => Buffer.from(Uint32Array.from(values).buffer);
        return Buffer.concat([
            words(0x46546c67, 2, 28 + json.length + this.length, json.length, 0x4e4f534a),
            json,
            words(this.length, 0x004e4942),
            ...this.bytes,
        ]);
    }
}

// `cameras`: whether they are 'perspective' or 'orthographic'. `sun`: of so many lux, whose node is in the middle of
// the room, which it does not reach.
export function glassRoom({ cameras = 'perspective', sun = 0 } = {}) {
    const room = new GlbBuilder();
    const material = (baseColor, roughnessFactor, more = {}) =>
        room.push('materials', {
            pbrMetallicRoughness: {
                baseColorFactor: [...baseColor, 1],
                metallicFactor: 0,
                roughnessFactor,
            },
            ...more,
        });
    const image = room.push('images', {
        bufferView: room.view(
            png([
                [255, 0, 0],
                [0, 0, 0],
            ]),
        ),
        mimeType: 'image/png',
    });
    const sampler = room.push('samplers', { magFilter: 9728, minFilter: 9728, wrapS: 33071, wrapT: 33071 });
    room.push('textures', { source: image, sampler });
    const glass = (transmission) => ({
        doubleSided: true,
        extensions: { KHR_materials_transmission: { transmissionFactor: 1, ...transmission } },
    });
    const white = material([0.8, 0.8, 0.8], 1),
        blue = material([0.1, 0.2, 0.8], 1),
        lamp = material([0, 0, 0], 1, {
            emissiveFactor: [1, 1, 1],
            extensions: { KHR_materials_emissive_strength: { emissiveStrength: 10 } },
        });
    const across = [4, 0, 0],
        up = [0, 3, 0],
        deep = [0, 0, 4];
    room.add(white, [
        [[-2, 0, -2], deep, across],
        [[-2, 3, -2], across, deep],
        [[-2, 0, -2], across, up],
        [[2, 0, 2], [-4, 0, 0], up],
        [[-2, 0, 2], [0, 0, -4], up],
        [[2, 0, -2], deep, up],
    ]);
    room.add(lamp, [[[-1, 2.99, -0.5], [2, 0, 0], [0, 0, 1.5]]]);
    // Strips that are twice as wide as the gaps between them: at the wall, and just behind the rough pane.
    const strips = (bottom, z) =>
        Array.from({ length: 5 }, (_, i) => [[0.2 + 0.3 * i, bottom, z], [0.2, 0, 0], [0, 0.7, 0]]);
    room.add(blue, strips(1.6, -1.95));
    room.add(blue, strips(0.6, -0.02));
    room.add(material([0.9, 0.3, 0.2], 0.5, glass({ transmissionTexture: { index: 0 } })), [
        [[-1.3, 0.6, 0], [1.2, 0, 0], [0, 1.6, 0]],
    ]);
    room.add(material([1, 1, 1], 0.4, glass({})), [[[0.1, 0.6, 0], [1.2, 0, 0], [0, 1.6, 0]]]);
    room.push('cameras', {
        type: cameras,
        [cameras]:
            cameras === 'perspective'
                ? { yfov: 1, aspectRatio: 16 / 9, znear: 0.01 }
                : { xmag: 2, ymag: 1.1, znear: 0.01, zfar: 10 },
    });
    // Two nodes show by one camera.
    for (const [name, x] of [
        ['middle', 0],
        ['aside', 1],
    ])
        room.json.scenes[0].nodes.push(
            room.push('nodes', { name, camera: 0, translation: [x, 1.4, 1.9] }),
        );
    if (sun > 0) {
        room.json.extensionsUsed.push('KHR_lights_punctual');
        room.json.extensions = {
            KHR_lights_punctual: { lights: [{ type: 'directional', intensity: sun }] },
        };
        // 45 degrees downward.
        const half = Math.PI / 8;
        room.json.scenes[0].nodes.push(
            room.push('nodes', {
                translation: [0, 1.5, 0],
                rotation: [-Math.sin(half), 0, 0, Math.cos(half)],
                extensions: { KHR_lights_punctual: { light: 0 } },
            }),
        );
    }
    return room.glb();
}
