// A measuring tape: the distance between two points that are tapped, or of the picture's middle by Enter. Loaded when it is
// asked for.
import { addStyles } from './shadow.js';
import styles from './tape.css';
import { kTapPixels, rayThrough } from './taps.js';

const kMarkup = `<svg aria-hidden="true" hidden><line/><circle r="5"/><circle r="5"/></svg><output role="status"></output>`;

export class Tape {
    // `host`: see element.js.
    constructor(host) {
        const { canvas, navigation } = host.viewer;
        Object.assign(this, { host, canvas, points: [], listening: new AbortController() });
        const { signal } = this.listening,
            listen = (target, name, handle) => target.addEventListener(name, handle, { signal });
        addStyles(host.shadowRoot, styles);
        this.element = document.createElement('div');
        this.element.id = 'tape';
        this.element.innerHTML = kMarkup;
        host.find('hotspots').before(this.element);
        [this.svg, this.output] = this.element.children;
        this.undoTaps = navigation.takeTaps();
        listen(canvas, 'pointerdown', ({ clientX: x, clientY: y }) => (this.down = { x, y }));
        listen(canvas, 'click', (event) => {
            const { x, y } = this.down ?? {};
            if (Math.hypot(event.clientX - x, event.clientY - y) <= kTapPixels) this.pick(event);
        });
        listen(canvas, 'keydown', ({ key }) => {
            const { left, top, width, height } = canvas.getBoundingClientRect();
            if (key === 'Enter') this.pick({ clientX: left + width / 2, clientY: top + height / 2 });
        });
        listen(host, 'camera-change', () => this.draw());
        this.draw();
    }

    // A third point begins anew.
    pick(place) {
        const { camera, walls } = this.host.viewer,
            [hit] = rayThrough(place, this.canvas, camera).intersectObject(walls.root, true);
        if (!hit) return;
        if (this.points.length === 2) this.points = [];
        this.points.push(hit.point);
        this.draw();
    }

    draw() {
        const { host, points, svg } = this,
            { camera } = host.viewer,
            { clientWidth, clientHeight } = this.canvas;
        camera.updateMatrixWorld();
        const places = points.map((point) => point.clone().project(camera)),
            inFront = places.length > 0 && places.every(({ z }) => z < 1);
        svg.toggleAttribute('hidden', !inFront);
        this.output.textContent = points.length === 2 ? this.length : host.words(`tape${points.length}`);
        if (!inFront) return;
        const [a, b] = [places[0], places.at(-1)].map(({ x, y }) => [((1 + x) / 2) * clientWidth, ((1 - y) / 2) * clientHeight]);
        const [line, ...ends] = svg.children;
        ['x1', 'y1', 'x2', 'y2'].forEach((name, i) => line.setAttribute(name, [...a, ...b][i]));
        [a, b].forEach(([x, y], i) => ['cx', 'cy'].forEach((name, axis) => ends[i].setAttribute(name, [x, y][axis])));
    }

    get length() {
        const { host, points } = this,
            { meter } = host.viewer.navigation;
        return `${host.numbers.format(points[0].distanceTo(points[1]) / meter)} m`;
    }

    dispose() {
        this.undoTaps();
        this.listening.abort();
        this.element.remove();
    }
}
