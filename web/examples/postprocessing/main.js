import {
    BloomEffect,
    EffectComposer,
    EffectPass,
    RenderPass,
    ToneMappingEffect,
    ToneMappingMode,
    VignetteEffect,
} from 'postprocessing';
import { HalfFloatType, PerspectiveCamera, Scene, WebGLRenderer } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { PhatexturesExtension, prepareLights } from 'phatextures';

const renderer = new WebGLRenderer({ antialias: false, stencil: false, depth: false });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);

const loader = new GLTFLoader();
loader.register((parser) => new PhatexturesExtension(parser));
const room = await loader.loadAsync('room.phat.glb');

const scene = new Scene();
scene.add(room.scene);
prepareLights(renderer, scene);
const camera = new PerspectiveCamera(40, innerWidth / innerHeight, 0.01, 100);
camera.position.setFromMatrixPosition(room.cameras[0].matrixWorld);
camera.lookAt(0, 0.8, 0);

// Radiance above 1, of lamps and of what they light, blooms; tone mapping comes after that.
const composer = new EffectComposer(renderer, { frameBufferType: HalfFloatType, multisampling: 4 });
composer.addPass(new RenderPass(scene, camera));
composer.addPass(
    new EffectPass(
        camera,
        new BloomEffect({ intensity: 0.5, luminanceThreshold: 1, mipmapBlur: true }),
        new ToneMappingEffect({ mode: ToneMappingMode.AGX }),
        new VignetteEffect(),
    ),
);
renderer.setAnimationLoop(() => composer.render());
