import { AgXToneMapping, PerspectiveCamera, Scene, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { PhatexturesExtension, prepareLights } from 'phatextures';

const renderer = new WebGLRenderer({ antialias: true });
renderer.toneMapping = AgXToneMapping;
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);

const loader = new GLTFLoader();
loader.register((parser) => new PhatexturesExtension(parser));
const room = await loader.loadAsync('room.phat.glb');

const scene = new Scene();
scene.add(room.scene);
prepareLights(renderer, scene); // shadows of the room's lamps and of its sun
const camera = new PerspectiveCamera(40, innerWidth / innerHeight, 0.01, 100);
camera.position.setFromMatrixPosition(room.cameras[0].matrixWorld);
const controls = new OrbitControls(camera, renderer.domElement);
controls.target.set(0, 0.8, 0);
controls.update();
renderer.setAnimationLoop(() => renderer.render(scene, camera));
