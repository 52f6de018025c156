// What moves in a room: the file's animations, and things that are dragged over the floor. Loaded where a file has any.
import { Box3, Plane, PropertyBinding, Vector3 } from 'three';
import { rayThrough } from './taps.js';

const kMaxStep = 0.1; // seconds of an animation a picture
const kTracks = /\.(position|quaternion|scale)$/;

// All clips at once, over and over.
class Player {
    constructor(root, clips) {
        this.seconds = 0;
        this.duration = Math.max(0, ...clips.map(({ duration }) => duration));
        this.tracks = clips
            .flatMap(({ tracks }) => tracks)
            .filter(({ name }) => kTracks.test(name))
            .map((track) => ({
                binding: PropertyBinding.create(root, track.name),
                interpolant: track.createInterpolant(),
            }));
    }

    advance(seconds) {
        this.seconds = (this.seconds + seconds) % this.duration;
        for (const { binding, interpolant } of this.tracks) binding.setValue(interpolant.evaluate(this.seconds), 0);
    }
}

export class Moves {
    // `host`: see element.js.
    constructor(host, { scene, animations }) {
        const { viewer } = host;
        Object.assign(this, { host, viewer, root: scene, player: new Player(scene, animations), canvas: viewer.canvas });
        this.bounds = new Box3().setFromObject(scene);
        this.movable = [];
        scene.traverse((object) => {
            if (object.userData.phat?.movable) this.movable.push(object);
        });
        this.offerDrags();
        this.offer();
    }

    // In the settings, if there are any.
    offer() {
        const { host, movable } = this,
            play = host.find('play');
        if (!play) return;
        const showPlayer = () => {
            play.textContent = host.words(this.playing ? 'pause' : 'play');
        };
        play.hidden = this.player.tracks.length === 0;
        play.addEventListener('click', async () => {
            this.playing = !this.playing;
            showPlayer();
            await this.follow();
            this.tick(performance.now());
        });
        showPlayer();
        const names = movable.map(({ name }) => name).filter(Boolean);
        if (movable.length > 0) this.say(host.words('draggable', { names: names.join(', ') || movable.length }));
        host.find('motion').hidden = false;
    }

    say(text) {
        const state = this.host.find('motionstate');
        if (state) state.textContent = text;
    }

    // Light follows from the first move on.
    async follow() {
        this.following ??= this.viewer.light.followChanges();
        try {
            await this.following;
        } catch (error) {
            this.say(error.message);
        }
    }

    tick(before) {
        requestAnimationFrame((now) => {
            if (!this.playing || this.host.viewer !== this.viewer) return;
            this.player.advance(Math.min((now - before) / 1000, kMaxStep));
            this.moved();
            this.tick(now);
        });
    }

    moved() {
        this.viewer.walls.still = false;
        this.viewer.drawShadows();
        this.viewer.viewChanged();
    }

    offerDrags() {
        const { canvas, movable } = this;
        if (movable.length === 0) return;
        // Before the view's own controls see it.
        canvas.addEventListener('pointerdown', (event) => this.grab(event), { capture: true });
        canvas.addEventListener('pointermove', (event) => this.drag(event), { capture: true });
        for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'])
            canvas.addEventListener(name, (event) => this.release(event), { capture: true });
    }

    aim(event) {
        return rayThrough(event, this.canvas, this.viewer.camera);
    }

    // The movable thing under the pointer, if nothing is before it.
    grab(event) {
        if (event.button !== 0 || this.held) return;
        const [hit] = this.aim(event).intersectObject(this.root, true);
        let object = hit?.object;
        while (object && !this.movable.includes(object)) object = object.parent;
        if (!object) return;
        event.stopImmediatePropagation();
        this.canvas.setPointerCapture(event.pointerId);
        this.held = {
            object,
            pointer: event.pointerId,
            plane: new Plane(new Vector3(0, 1, 0), -hit.point.y),
            last: hit.point.clone(),
        };
        this.follow();
    }

    // Over the floor: its height stays.
    drag(event) {
        const { held, bounds } = this;
        if (event.pointerId !== held?.pointer) return;
        event.stopImmediatePropagation();
        const at = this.aim(event).ray.intersectPlane(held.plane, new Vector3());
        if (!at) return;
        at.clamp(bounds.min, bounds.max);
        const { object } = held,
            place = object.getWorldPosition(new Vector3()).add(at).sub(held.last);
        object.position.copy(object.parent.worldToLocal(place));
        held.last = at;
        this.moved();
    }

    release(event) {
        if (event.pointerId !== this.held?.pointer) return;
        event.stopImmediatePropagation();
        this.held = null;
    }
}
