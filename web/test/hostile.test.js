// Files that promise less than they hold. Needs no browser.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { after, before, test } from 'node:test';
import { deflateSync } from 'node:zlib';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { kName } from '../src/file.js';
import { borrowRoom } from './room.js';

const kBombBytes = 1 << 28, // 260 kB of the file
    kChunkBytes = 1 << 20; // far more than a decompressor holds at once

let room, dispose, PhatexturesExtension, inflated;
const Original = globalThis.DecompressionStream;

// Counts what it inflates.
class CountingStream {
    constructor(format) {
        const { writable, readable } = new Original(format);
        const count = new TransformStream({
            transform: (chunk, controller) => {
                inflated += chunk.length;
                controller.enqueue(chunk);
            },
        });
        Object.assign(this, { writable, readable: readable.pipeThrough(count) });
    }
}

before(async () => {
    ({ value: room, dispose } = await borrowRoom('lamps'));
    ({ PhatexturesExtension } = await import('../dist/phatextures.js'));
    globalThis.DecompressionStream = CountingStream;
});
after(async () => {
    globalThis.DecompressionStream = Original;
    await dispose?.();
});

// A baked file with other bytes in place of a payload, whose stated size stays what it was.
function withPayload(glb, payloadOf, bytes) {
    const jsonBytes = glb.readUInt32LE(12),
        json = JSON.parse(glb.subarray(20, 20 + jsonBytes).toString()),
        binary = glb.subarray(28 + jsonBytes),
        view = json.bufferViews[payloadOf(json.extensions[kName]).bufferView];
    Object.assign(view, { byteOffset: binary.length, byteLength: bytes.length });
    json.buffers[0].byteLength = binary.length + bytes.length;
    const text = JSON.stringify(json),
        chunk = (type, data, fill) => {
            const padded = Buffer.concat([data, Buffer.alloc(-data.length & 3, fill)]),
                head = Buffer.alloc(8);
            head.writeUInt32LE(padded.length, 0);
            head.write(type, 4, 'latin1');
            return Buffer.concat([head, padded]);
        };
    const body = Buffer.concat([chunk('JSON', Buffer.from(text), ' '), chunk('BIN\0', Buffer.concat([binary, bytes]), 0)]),
        head = Buffer.from(glb.subarray(0, 12));
    head.writeUInt32LE(12 + body.length, 8);
    return Buffer.concat([head, body]);
}

function parse(glb) {
    const loader = new GLTFLoader();
    loader.register((parser) => new PhatexturesExtension(parser));
    inflated = 0;
    return loader.parseAsync(glb.buffer.slice(glb.byteOffset, glb.byteOffset + glb.length), '');
}

test('what inflates to more than the file says is not inflated, and named', async () => {
    const glb = await readFile(room.file),
        bomb = deflateSync(Buffer.alloc(kBombBytes)),
        good = await parse(glb);
    await good.userData.bakedLight.ready;
    const usual = inflated;
    assert.ok(usual > 0 && usual < kBombBytes / 4, `${usual}`);
    // Of what is read before the room is shown.
    await assert.rejects(parse(withPayload(glb, ({ atlas }) => atlas.charts, bomb)), /the list of charts is larger than/);
    assert.ok(inflated < usual + kChunkBytes, `${inflated} bytes`);
    // Of what follows.
    const { userData } = await parse(withPayload(glb, ({ indirect }) => indirect.layers[0].radiance, bomb));
    await assert.rejects(userData.bakedLight.ready, /the radiance is larger than the file says/);
    assert.ok(inflated < usual + kChunkBytes, `${inflated} bytes`);
});

test('what inflates to less is named, too', async () => {
    const glb = withPayload(await readFile(room.file), ({ atlas }) => atlas.charts, deflateSync(Buffer.alloc(4)));
    await assert.rejects(parse(glb), /the list of charts is cut off/);
});
