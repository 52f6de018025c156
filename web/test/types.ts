// A page in TypeScript that uses all of the package: compiled by types.test.js, and never run.
import { Color, DataTexture, MeshStandardMaterial, MeshToonMaterial, Object3D, Scene, WebGLRenderer } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import {
    BakedLight,
    PhatexturesExtension,
    bakedLightOf,
    isSupported,
    jitterOf,
    prepareLights,
    type Lamp,
} from 'phatextures';

// Compiles where both types are the same.
type Same<A, B> = (<T>() => T extends A ? 1 : 2) extends <T>() => T extends B ? 1 : 2 ? true : false;
const assertSame = <A, B>(_: Same<A, B>): void => {};

const loader = new GLTFLoader();
loader.register((parser) => new PhatexturesExtension(parser));
const gltf = await loader.loadAsync('room.phat.glb');
const light = bakedLightOf(gltf);
assertSame<typeof light, BakedLight | null>(true);
// @ts-expect-error: a file may not be baked
light.enabled = true;

async function use(of: BakedLight): Promise<void> {
    assertSame<typeof of.ready, Promise<BakedLight>>(true);
    assertSame<typeof of.environment, DataTexture | null>(true);
    assertSame<typeof of.quality, 'fast' | 'default' | 'high'>(true);
    assertSame<typeof of.reflections, 'auto' | 'lookup' | 'rays'>(true);
    assertSame<typeof of.onProgress, (() => void) | null>(true);
    assertSame<typeof of.root, Object3D>(true);
    assertSame<typeof of.lights, Promise<Lamp[]>>(true);
    const numbers: number[] = [of.progress, of.tracedMilliseconds, of.updatedMilliseconds, of.unitMeters],
        states: boolean[] = [of.isSettled, of.isWhole];
    of.onProgress = () => console.log(numbers, states);
    Object.assign(of, { reflectionMilliseconds: Infinity, updateMilliseconds: 4, seed: 1, wipe: 0.5 });
    of.waitsForPrograms = of.enabled = true;
    // @ts-expect-error: there is no such quality
    of.quality = 'full';
    // @ts-expect-error: the bake says it
    of.progress = 1;
    // @ts-expect-error: for the package's own files
    of.bake = null;
    // @ts-expect-error: made by the plug-in alone
    new BakedLight();
    await of.followChanges();
    await of.add(new Object3D());
    of.remove(new Object3D());
    of.adopt(new MeshStandardMaterial());
    // @ts-expect-error: it throws for others
    of.adopt(new MeshToonMaterial());
    const [lamp] = await of.lights;
    assertSame<typeof lamp.color, Color>(true);
    lamp.color = 'orange';
    lamp.intensity = lamp.visible ? 0.5 : 1;
    // @ts-expect-error: it is that of the file
    lamp.name = 'Ceiling';
    lamp.reset();
    of.dispose();
    of.detach();
}
if (light) await use(light);

const renderer = new WebGLRenderer();
prepareLights(renderer, new Scene());
const [x, y]: [number, number] = jitterOf(0, 16);
export const supported: boolean = isSupported(renderer.getContext()) && x < y;
