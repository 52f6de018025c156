import { AgXToneMapping, PerspectiveCamera, Scene, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { PhatexturesExtension, bakedLightOf, prepareLights } from 'phatextures';

const renderer = new WebGLRenderer({ antialias: true });
renderer.toneMapping = AgXToneMapping;
document.body.append(renderer.domElement);

const loader = new GLTFLoader();
loader.register((parser) => new PhatexturesExtension(parser));
const room = await loader.loadAsync(`${import.meta.env.BASE_URL}room.phat.glb`);
const light = bakedLightOf(room);
if (!light) throw new Error('room.phat.glb is not baked');

const scene = new Scene();
scene.add(room.scene);
prepareLights(renderer, scene);
const camera = new PerspectiveCamera(40, 1, 0.01, 100);
camera.position.setFromMatrixPosition(room.cameras[0].matrixWorld);
const controls = new OrbitControls(camera, renderer.domElement);
controls.target.set(0, 0.8, 0);
controls.update();

function resize(): void {
    camera.aspect = innerWidth / innerHeight;
    camera.updateProjectionMatrix();
    renderer.setSize(innerWidth, innerHeight);
}
addEventListener('resize', resize);
resize();
renderer.setAnimationLoop(() => renderer.render(scene, camera));

// Space switches the room's lamps.
addEventListener('keydown', async ({ key }) => {
    if (key !== ' ') return;
    for (const lamp of await light.lights) lamp.visible = !lamp.visible;
});
