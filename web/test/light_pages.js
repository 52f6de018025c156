// Pages of baked rooms of lampRoom whose light changes.
import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { borrowBrowser, serve } from './browser.js';
import { lampRoom } from './lamp_room.js';
import { phat, readExr, smallPoster } from './room.js';
import { loaded, open } from './site.js';

// Few texels: a software driver traces the rays.
const texels = '8k';
// Where no picture is compared with that of another bake.
export const fewest = '2k';

export class LightPages {
    async begin() {
        this.folder = await mkdtemp(join(tmpdir(), 'phat-lights-'));
        this.browser = await borrowBrowser('gl-egl');
    }

    async end() {
        await this.browser?.dispose();
        if (this.folder) await rm(this.folder, { recursive: true });
    }

    // The baked file of a room of lampRoom.
    async bake(name, room, { resolution = texels, seed = '1', samples = '1' } = {}) {
        const [scene, file] = [`${name}.glb`, `${name}.phat.glb`].map((of) => join(this.folder, of));
        await writeFile(scene, lampRoom(room));
        const flags = Object.entries({ resolution, seed, samples, photons: '100k' });
        await phat('bake', scene, '-o', file, '--quiet', ...flags.flatMap(([key, value]) => [`--${key}`, value]));
        return file;
    }

    async open(t, file, options) {
        const site = file.replace('.phat.glb', '');
        await phat('web', file, '-o', site, '--exposure', '1', ...smallPoster, '--quiet');
        const server = await serve(site);
        const page = await loaded(await open(this.browser.value, server.url, options));
        t.after(async () => {
            await page.close();
            server.close();
        });
        return page;
    }
}

export async function rendered(file) {
    const picture = file.replace('.phat.glb', '.exr');
    await phat('render', file, '-o', picture, '--size', '160x90', '--spp', '4', '--reflections', 'lookup', '--quiet');
    return (await readExr(picture)).pixels;
}

// Sets lamps by name, and draws until the light has settled, or each texel has had `rounds` rays. Returns how many pictures
// that took.
export const settled = (page, settings, rounds = Infinity) =>
    page.evaluate(async ([all, most]) => {
        const { light } = viewer,
            isDone = () => light.isSettled || light.updates.last?.order.rounds.every((made) => made >= most);
        light.updateMilliseconds = Infinity;
        light.waitsForPrograms = true;
        for (const lamp of await light.lights) Object.assign(lamp, all[lamp.name]);
        let pictures = 0;
        for (; !isDone(); ++pictures) {
            viewer.changed();
            viewer.addSample('fast', 1);
            await new Promise((done) => {
                setTimeout(done);
            });
        }
        return pictures;
    }, [settings, rounds]);

export const errorOf = (page) => page.evaluate(() => viewer.renderer.getContext().getError());
