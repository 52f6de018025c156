export { BakedLight, PhatexturesExtension, bakedLightOf } from './extension.js';
export { isSupported } from './gl.js';
export { jitterOf } from './sample_numbers.js';
export { prepareLights } from './shadows.js';
