// A BakedLight without a room, for what needs no browser.
import { deflateSync } from 'node:zlib';
import { Object3D } from 'three';

// A light with nothing but an environment, whose bytes `deliver` sends.
export async function lightOfEnvironment() {
    const { BakedLight } = await import('../dist/phatextures.js');
    let deliver;
    const parser = {
        getDependency: () =>
            new Promise((done) => {
                deliver = () => done(deflateSync(new Uint8Array(4)));
            }),
    };
    const description = {
        environment: { size: [1, 1], scale: 1, radiance: { bufferView: 0, byteLength: 4 } },
        indirect: { guideCount: 0, layers: [] },
        area: { layers: [] },
    };
    const bake = { atlas: { unitMeters: 1 }, surfaces: { drawRanges: [] }, lookup: null };
    return { light: new BakedLight(new Object3D(), parser, description, bake), deliver };
}
