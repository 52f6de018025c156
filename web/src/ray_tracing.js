// What rays need, loaded with the first trees that are read: not every device is fast enough for them.
import shaders from 'phat:ray-shaders';
import { addShaders } from './gl.js';

addShaders(shaders);

export { poseScene } from './posed_trees.js';
export { RayPass, RayPrograms, bindHitLights, shadeHits } from './ray_pass.js';
export { RayScene } from './ray_scene.js';
export { readTrees } from './trees.js';
export { TreeRays } from './tree_rays.js';
