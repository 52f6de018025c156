// What people use: MeshStandardMaterial, a RectAreaLight for each area light, shadow maps for the others, and a prefiltered
// probe whose reflections are projected on the room's box. With ?grid diffuse light is that of three.js's grid of irradiance
// probes, which the environment probe shows, too. All probes are made here, as a page without a bake would.
import {
    Box3,
    FloatType,
    LinearSRGBColorSpace,
    PMREMGenerator,
    RectAreaLight,
    Scene,
    ShaderChunk,
    Vector3,
    WebGLRenderTarget,
    WebGLRenderer,
} from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { LightProbeGridWebGL } from 'three/addons/lighting/LightProbeGridWebGL.js';
import { RectAreaLightUniformsLib } from 'three/addons/lights/RectAreaLightUniformsLib.js';

// Metres between irradiance probes, and along a side at most so many; how often light is reflected.
const kProbeDistance = 0.5,
    kMaxProbes = 8,
    kBounces = 3;
const kShadowTexels = 1024,
    kShadowBias = 0.02; // metres
const hasGrid = new URLSearchParams(location.search).has('grid');

RectAreaLightUniformsLib.init();
const renderer = new WebGLRenderer({ canvas: document.getElementById('view'), antialias: false });
renderer.outputColorSpace = LinearSRGBColorSpace;
renderer.setSize(innerWidth, innerHeight, false);
renderer.shadowMap.enabled = true;
const gltf = await new GLTFLoader().loadAsync('room.glb');
const scene = new Scene();
scene.add(gltf.scene);

// An area light here is a flat emissive mesh that faces down.
function addLamp(mesh) {
    const box = new Box3().setFromObject(mesh),
        size = box.getSize(new Vector3()),
        middle = box.getCenter(new Vector3());
    const { emissive, emissiveIntensity } = mesh.material;
    const lamp = new RectAreaLight(emissive, emissiveIntensity, size.x, size.z);
    lamp.position.copy(middle);
    lamp.position.y = box.min.y - 1e-3 * size.x; // before the surface
    lamp.lookAt(lamp.position.clone().add(new Vector3(0, -1, 0)));
    scene.add(lamp);
}

// Without a bias surfaces shade themselves in stripes.
function castShadow(light) {
    light.castShadow = true;
    light.shadow.mapSize.setScalar(kShadowTexels);
    light.shadow.normalBias = kShadowBias;
}

// Parallax correction [Lagarde and Zanuttini 2012]: the reflected ray meets the box, as seen from the probe's position.
function projectOnBox(material, box, probe) {
    material.onBeforeCompile = (shader) => {
        Object.assign(shader.uniforms, {
            boxLow: { value: box.min },
            boxHigh: { value: box.max },
            probe: { value: probe },
        });
        shader.vertexShader = `varying vec3 vBoxPosition;\n${shader.vertexShader.replace(
            '#include <project_vertex>',
            '#include <project_vertex>\nvBoxPosition = (modelMatrix * vec4(transformed, 1.0)).xyz;',
        )}`;
        shader.fragmentShader = `varying vec3 vBoxPosition;\nuniform vec3 boxLow, boxHigh, probe;\n${shader.fragmentShader.replace(
            '#include <envmap_physical_pars_fragment>',
            hasGrid ? boxedChunk + diffuseByGrid : boxedChunk,
        )}`;
    };
}
const worldReflection = 'reflectVec = transformDirectionByInverseViewMatrix( reflectVec, viewMatrix );';
const boxedChunk = ShaderChunk.envmap_physical_pars_fragment.replace(
    worldReflection,
    `${worldReflection}
    vec3 toward = max((boxHigh - vBoxPosition) / reflectVec, (boxLow - vBoxPosition) / reflectVec);
    reflectVec = vBoxPosition + reflectVec * min(min(toward.x, toward.y), toward.z) - probe;`,
);
if (!boxedChunk.includes('boxHigh')) throw new Error('three.js has another chunk than this page knows');
const diffuseByGrid = '\n#define getIBLIrradiance(normal) vec3(0.0)\n';

const materials = new Set(),
    lamps = [];
gltf.scene.traverse((object) => {
    if (object.shadow) castShadow(object); // punctual lights
    if (!object.isMesh) return;
    object.castShadow = object.receiveShadow = true;
    materials.add(object.material);
    if (object.material.emissive?.getHex() && object.material.emissiveIntensity > 1) {
        addLamp(object);
        lamps.push(object);
    }
});
const box = new Box3().setFromObject(gltf.scene),
    probe = box.getCenter(new Vector3());

function bakeGrid() {
    const size = box.getSize(new Vector3()).toArray(),
        counts = size.map((meters) => Math.min(Math.max(Math.round(meters / kProbeDistance), 2), kMaxProbes));
    const grid = new LightProbeGridWebGL(...size, ...counts);
    grid.position.copy(probe);
    scene.add(grid);
    grid.bake(renderer, scene, { bounces: kBounces, near: 0.01 });
}
// Probes of both kinds do not see the lamps then, whose light and highlights are those of the RectAreaLights.
for (const lamp of lamps) lamp.visible = !hasGrid;
if (hasGrid) bakeGrid();
const environment = new PMREMGenerator(renderer).fromScene(scene, 0, 0.01, 100, { position: probe }).texture;
for (const lamp of lamps) lamp.visible = true;
for (const material of materials) {
    projectOnBox(material, box, probe);
    material.needsUpdate = true;
}
scene.environment = environment;

const [camera] = gltf.cameras;
const target = new WebGLRenderTarget(innerWidth, innerHeight, { type: FloatType });
camera.aspect = innerWidth / innerHeight;
camera.updateProjectionMatrix();

// Mean linear radiance of `count` jittered pictures, as viewer.render has it.
function render(count) {
    const sum = new Float32Array(4 * innerWidth * innerHeight),
        pixels = new Float32Array(sum.length);
    renderer.setRenderTarget(target);
    for (let i = 0; i < count; ++i) {
        camera.setViewOffset(
            innerWidth,
            innerHeight,
            i / count - 0.5,
            ((i * 0.618) % 1) - 0.5,
            innerWidth,
            innerHeight,
        );
        renderer.render(scene, camera);
        renderer.readRenderTargetPixels(target, 0, 0, innerWidth, innerHeight, pixels);
        pixels.forEach((x, j) => {
            sum[j] += x / count;
        });
    }
    return sum;
}
render(1); // the first picture
globalThis.peer = { render };
