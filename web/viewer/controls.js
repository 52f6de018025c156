// Buttons in the picture, and the settings: what a viewer with the attribute `controls` has. Loaded with the room's light.
import styles from './controls.css';
import { offerComparison } from './compare.js';
import { kMarkup } from './controls_markup.js';
import { offerHeadset } from './headset_button.js';
import { createPanel } from './panel.js';
import { addStyles } from './shadow.js';
import { addressOf } from './share.js';
import { translate } from './strings/strings.js';
import { createViewpoints } from './viewpoints.js';

const kToastMilliseconds = 3000;

export class Controls {
    constructor(host) {
        this.host = host;
        this.listening = new AbortController();
        this.element = host.find('controls');
        this.element.innerHTML = kMarkup;
        addStyles(host.shadowRoot, styles);
        translate(this.element, host.words);
        const find = (id) => host.find(id);
        this.viewpoints = createViewpoints(host, this.listening.signal);
        this.offerTools(find);
        this.offerSettings(find);
        createPanel(host, this.listening.signal);
        offerComparison(host);
        host.viewer.moves?.offer();
    }

    on(element, name, handle) {
        element.addEventListener(name, handle, { signal: this.listening.signal });
    }

    offerTools(find) {
        const { host } = this,
            showMode = () => {
                const { mode } = host.viewer.navigation;
                find('orbit').setAttribute('aria-pressed', mode === 'orbit');
                find('pointers').textContent = host.words(mode === 'orbit' ? 'pointerOrbit' : 'pointerWalk');
                find('keys').textContent = host.words(mode === 'orbit' ? 'keysOrbit' : 'keysWalk');
            };
        this.on(host, 'camera-change', showMode);
        showMode();
        this.on(find('orbit'), 'click', () => {
            host.mode = host.viewer.navigation.mode === 'orbit' ? 'walk' : 'orbit';
            host.viewer.navigation.ask(host.mode);
        });
        this.on(find('measure'), 'click', () => this.measure(find('measure')));
        this.on(find('screenshot'), 'click', () => this.savePicture());
        find('share').hidden = !host.hasAttribute('share');
        this.on(find('share'), 'click', () => this.copyLink());
        const { signal } = this.listening;
        offerHeadset(host, find('headset'), { signal, say: (text) => this.say(text) });
        find('fullscreen').hidden = !document.fullscreenEnabled;
        this.on(find('fullscreen'), 'click', () =>
            document.fullscreenElement ? document.exitFullscreen() : host.requestFullscreen().catch(console.warn),
        );
    }

    offerSettings(find) {
        const [settings, panel] = [find('settings'), find('panel')];
        const open = (isOpen) => {
            panel.hidden = !isOpen;
            settings.setAttribute('aria-expanded', isOpen);
            (isOpen ? find('close') : settings).focus({ preventScroll: true });
        };
        this.on(settings, 'click', () => open(panel.hidden));
        this.on(find('close'), 'click', () => open(false));
        this.on(panel, 'keydown', ({ key }) => key === 'Escape' && open(false));
    }

    async measure(button) {
        const isOn = button.getAttribute('aria-pressed') !== 'true';
        button.setAttribute('aria-pressed', isOn);
        const { Tape } = await import('./tape.js');
        this.tape?.dispose();
        this.tape = isOn && !this.listening.signal.aborted ? new Tape(this.host) : null;
    }

    async savePicture() {
        const link = document.createElement('a'),
            url = URL.createObjectURL(await this.host.toBlob());
        Object.assign(link, { href: url, download: `${document.title || 'room'}.png` });
        link.click();
        setTimeout(() => URL.revokeObjectURL(url), kToastMilliseconds);
    }

    async copyLink() {
        const { host } = this,
            address = addressOf(host.view);
        history.replaceState(history.state, '', address);
        try {
            await navigator.clipboard.writeText(address);
            this.say(host.words('shared'));
        } catch {
            this.say(host.words('notShared'));
        }
    }

    say(text) {
        const toast = this.host.find('toast');
        toast.textContent = text;
        clearTimeout(this.saying);
        this.saying = setTimeout(() => (toast.textContent = ''), kToastMilliseconds);
    }

    dispose() {
        clearTimeout(this.saying);
        this.viewpoints.stop();
        this.tape?.dispose();
        this.listening.abort();
        this.element.replaceChildren();
    }
}
