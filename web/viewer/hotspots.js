// Notes in a room: nodes whose extras are {"phat": {"hotspot": "Text", "link": "https://..."}}. Loaded where a file has any.
import { Vector3 } from 'three';
import styles from './hotspots.css';
import { addStyles } from './shadow.js';

const kBeforeSurface = 0.02; // of its distance: a note may lie in a surface

// A whole button is in the picture.
const within = (percent) => `clamp(22px, ${percent}%, 100% - 22px)`;

// Its address if it leads to a web page, and nothing else that a file may say.
function addressOf(link) {
    try {
        const url = new URL(link);
        return ['http:', 'https:'].includes(url.protocol) ? url.href : '';
    } catch {
        return '';
    }
}

class Hotspot {
    constructor(node, number, words) {
        const { hotspot, link } = node.userData.phat,
            address = addressOf(link);
        this.node = node;
        this.element = document.createElement('div');
        Object.assign(this.element, { className: 'hotspot', hidden: true }); // until it is placed
        this.button = document.createElement('button');
        Object.assign(this.button, { type: 'button', textContent: number });
        this.button.setAttribute('aria-label', words('hotspot', { text: hotspot }));
        this.button.setAttribute('aria-expanded', 'false');
        this.note = document.createElement('div');
        Object.assign(this.note, { className: 'note', hidden: true });
        const text = document.createElement('p');
        text.textContent = hotspot;
        this.note.append(text);
        if (address) {
            const anchor = document.createElement('a');
            Object.assign(anchor, { href: address, target: '_blank', rel: 'noopener noreferrer', textContent: words('open') });
            this.note.append(anchor);
        }
        this.element.append(this.button, this.note);
    }

    open(isOpen) {
        this.note.hidden = !isOpen;
        this.button.setAttribute('aria-expanded', isOpen);
    }
}

export class Hotspots {
    // `host`: see element.js.
    constructor(host, root) {
        this.host = host;
        this.layer = host.find('hotspots');
        this.all = [];
        addStyles(host.shadowRoot, styles);
        root.traverse((node) => {
            if (typeof node.userData.phat?.hotspot === 'string')
                this.all.push(new Hotspot(node, this.all.length + 1, host.words));
        });
        this.all.forEach((hotspot) => {
            hotspot.button.addEventListener('click', () => this.toggle(hotspot));
            hotspot.element.addEventListener('keydown', ({ key }) => key === 'Escape' && this.toggle(null));
        });
        this.layer.replaceChildren(...this.all.map(({ element }) => element));
        this.listening = new AbortController();
        host.addEventListener('camera-change', () => this.place(), { signal: this.listening.signal });
        this.resizing = new ResizeObserver(() => this.place());
        this.resizing.observe(this.layer);
    }

    // One at a time.
    toggle(chosen) {
        for (const hotspot of this.all) hotspot.open(hotspot === chosen && hotspot.note.hidden);
    }

    // Once a frame, however often the view changes.
    place() {
        this.placing ??= requestAnimationFrame(() => {
            this.placing = null;
            const { viewer } = this.host;
            if (viewer) this.all.forEach((hotspot) => this.placeOne(hotspot, viewer));
        });
    }

    placeOne({ node, element }, { camera, walls }) {
        const at = node.getWorldPosition(new Vector3()),
            way = at.clone().sub(camera.position),
            distance = way.length(),
            free = (1 - kBeforeSurface) * distance;
        camera.updateMatrixWorld();
        const { x, y, z } = at.project(camera),
            isSeen = Math.abs(x) < 1 && Math.abs(y) < 1 && z < 1 && walls.distance(camera.position, way.normalize(), free) >= free;
        element.hidden = !isSeen;
        element.style.left = within(50 * (1 + x));
        element.style.top = within(50 * (1 - y));
        element.classList.toggle('left', x > 0);
        element.classList.toggle('above', y < 0);
    }

    dispose() {
        cancelAnimationFrame(this.placing);
        this.listening.abort();
        this.resizing.disconnect();
        this.layer.replaceChildren();
    }
}
