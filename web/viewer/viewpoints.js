// The file's cameras: from one to the next, by name, or all in turn.
import { kIcons } from './controls_markup.js';

const kDwellSeconds = 5; // at each of a tour, with the way there

export function createViewpoints(host, signal) {
    const { viewer } = host,
        [camera, tour] = ['camera', 'tour'].map((id) => host.find(id)),
        names = host.viewpoints;
    let touring = null;
    camera.append(...names.map((name, i) => new Option(name, i)));
    const shown = () => viewer.cameras.indexOf(viewer.navigation.first);
    const show = () => {
        const { trip } = viewer.navigation;
        camera.value = trip ? viewer.cameras.indexOf(trip.view) : shown();
    };
    const go = (i) => {
        viewer.navigation.travel(viewer.cameras[(i + names.length) % names.length]);
        show();
    };
    const stop = () => {
        clearInterval(touring);
        touring = null;
        tour.setAttribute('aria-pressed', 'false');
        tour.querySelector('path').setAttribute('d', kIcons.play);
    };
    const start = () => {
        go(Number(camera.value) + 1);
        touring = setInterval(() => go(Number(camera.value) + 1), 1000 * kDwellSeconds);
        tour.setAttribute('aria-pressed', 'true');
        tour.querySelector('path').setAttribute('d', kIcons.pause);
    };
    const step = (by) => {
        stop();
        go(Number(camera.value) + by);
    };
    camera.addEventListener('change', () => step(0), { signal });
    host.find('previous').addEventListener('click', () => step(-1), { signal });
    host.find('next').addEventListener('click', () => step(1), { signal });
    tour.addEventListener('click', () => (touring ? stop() : start()), { signal });
    // Who looks around by hand has left the tour.
    host.addEventListener('camera-change', ({ detail }) => {
        if (touring && detail.source === 'user-interaction') stop();
    }, { signal });
    host.addEventListener('camera-change', show, { signal });
    show();
    host.find('places').hidden = names.length === 0;
    for (const id of ['previous', 'next', 'tour']) host.find(id).hidden = names.length < 2;
    return { stop };
}
