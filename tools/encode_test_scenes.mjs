// Makes tests/data/encoded: one small scene, plain and as the usual web tools compress it. The packages are not
// among those of the page; install them anywhere and run it there:
//   npm install @gltf-transform/core@4.5.1 @gltf-transform/extensions@4.5.1 @gltf-transform/functions@4.5.1 \
//       draco3dgltf@1.5.7 meshoptimizer@0.25.0 sharp
//   node REPOSITORY/tools/encode_test_scenes.mjs REPOSITORY/tests/data/encoded
import { createRequire } from 'node:module'
import path from 'node:path'
import { pathToFileURL } from 'node:url'

const require = createRequire(path.join(process.cwd(), 'package.json'))
const load = async (name) => {
    const module = await import(pathToFileURL(require.resolve(name)).href)
    return { ...module.default, ...module }
}
const { Document, NodeIO } = await load('@gltf-transform/core')
const { ALL_EXTENSIONS, KHRDracoMeshCompression, EXTMeshoptCompression } = await load('@gltf-transform/extensions')
const { draco, instance, meshopt, quantize, textureCompress } = await load('@gltf-transform/functions')
const draco3d = await load('draco3dgltf')
const { MeshoptEncoder, MeshoptDecoder } = await load('meshoptimizer')
const sharp = (await load('sharp')).default
await MeshoptEncoder.ready
await MeshoptDecoder.ready

// A sphere with normals, uv and colours, shown six times, once mirrored, on a textured floor.
async function scene() {
    const document = new Document()
    const buffer = document.createBuffer()
    const root = document.createScene()
    const accessor = (type, array) => document.createAccessor().setType(type).setArray(array).setBuffer(buffer)

    const side = 16
    const pixels = Buffer.alloc(side * side * 4)
    for (let y = 0; y < side; ++y)
        for (let x = 0; x < side; ++x) pixels.set([x * 16, y * 16, (x ^ y) & 4 ? 200 : 60, 128 + x * 8], (y * side + x) * 4)
    const png = await sharp(pixels, { raw: { width: side, height: side, channels: 4 } }).png().toBuffer()
    const texture = document.createTexture('ramp').setImage(new Uint8Array(png)).setMimeType('image/png')
    const plain = document.createMaterial('plain').setRoughnessFactor(0.4).setMetallicFactor(0)
    const textured = document.createMaterial('textured').setBaseColorTexture(texture).setMetallicFactor(0)

    const rings = 12, sectors = 18
    const positions = [], normals = [], uvs = [], colors = [], indices = []
    for (let r = 0; r <= rings; ++r)
        for (let s = 0; s <= sectors; ++s) {
            const theta = (Math.PI * r) / rings, phi = (2 * Math.PI * s) / sectors
            const n = [Math.sin(theta) * Math.cos(phi), Math.cos(theta), Math.sin(theta) * Math.sin(phi)]
            normals.push(...n)
            positions.push(n[0] * 0.5, n[1] * 0.7, n[2] * 0.5)
            uvs.push(s / sectors, r / rings)
            colors.push(Math.round(255 * (s / sectors)), Math.round(255 * (r / rings)), 128, 255)
        }
    for (let r = 0; r < rings; ++r)
        for (let s = 0; s < sectors; ++s) {
            const a = r * (sectors + 1) + s, b = a + sectors + 1
            if (r > 0) indices.push(a, a + 1, b)
            if (r < rings - 1) indices.push(a + 1, b + 1, b)
        }
    const sphere = document.createMesh('sphere').addPrimitive(
        document.createPrimitive().setMaterial(plain)
            .setIndices(accessor('SCALAR', new Uint16Array(indices)))
            .setAttribute('POSITION', accessor('VEC3', new Float32Array(positions)))
            .setAttribute('NORMAL', accessor('VEC3', new Float32Array(normals)))
            .setAttribute('TEXCOORD_0', accessor('VEC2', new Float32Array(uvs)))
            .setAttribute('COLOR_0', accessor('VEC4', new Uint8Array(colors)).setNormalized(true)))
    for (let i = 0; i < 6; ++i)
        root.addChild(document.createNode('ball').setMesh(sphere).setTranslation([2 * i - 5, 0.7, i % 2])
            .setRotation([0, Math.sin(0.2 * i), 0, Math.cos(0.2 * i)])
            .setScale([i === 5 ? -1 : 1, 1, 1 + 0.1 * i]))
    const floor = document.createMesh('floor').addPrimitive(
        document.createPrimitive().setMaterial(textured)
            .setIndices(accessor('SCALAR', new Uint16Array([0, 2, 1, 1, 2, 3])))
            .setAttribute('POSITION', accessor('VEC3', new Float32Array([-6, 0, -3, 6, 0, -3, -6, 0, 3, 6, 0, 3])))
            .setAttribute('NORMAL', accessor('VEC3', new Float32Array([0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0])))
            .setAttribute('TEXCOORD_0', accessor('VEC2', new Float32Array([0, 0, 1, 0, 0, 1, 1, 1]))))
    root.addChild(document.createNode('floor').setMesh(floor))
    return document
}

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
    'draco3d.encoder': await draco3d.createEncoderModule(),
    'draco3d.decoder': await draco3d.createDecoderModule(),
    'meshopt.encoder': MeshoptEncoder,
    'meshopt.decoder': MeshoptDecoder
})
const bits = { quantizePosition: 14, quantizeNormal: 12, quantizeTexcoord: 14, quantizeColor: 8 }
const encodings = {
    plain: [],
    draco: [draco({ ...bits, method: 'edgebreaker' })],
    'draco-sequential': [draco({ ...bits, method: 'sequential' })],
    meshopt: [meshopt({ encoder: MeshoptEncoder, level: 'medium', ...bits })],
    'meshopt-filters': [meshopt({ encoder: MeshoptEncoder, level: 'high', ...bits })],
    quantize: [quantize({ ...bits })],
    webp: [textureCompress({ encoder: sharp, targetFormat: 'webp', lossless: true })],
    avif: [textureCompress({ encoder: sharp, targetFormat: 'avif', lossless: true })],
    instance: [instance({ min: 2 })]
}
for (const [name, transforms] of Object.entries(encodings)) {
    const document = await scene()
    await document.transform(...transforms)
    await io.write(path.join(process.argv[2], `${name}.glb`), document)
}
