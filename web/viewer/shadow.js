// What is inside of a <phat-viewer>.
import styles from './element.css';

const kMarkup = `
<div id="stage" part="stage">
<slot name="poster"><img part="poster" alt=""></slot>
<p id="help" class="unseen"></p>
<div id="hotspots"></div>
<div id="controls"></div>
<slot name="progress"><progress part="progress" data-label="loading" max="1" value="0" hidden></progress></slot>
<slot name="message"><p part="message" role="alert" hidden></p></slot>
<slot></slot>
</div>`;

const sheets = new Map(); // by their texts

// Once, however often it is asked for.
export function addStyles(root, text) {
    if (!sheets.has(text)) {
        sheets.set(text, new CSSStyleSheet());
        sheets.get(text).replaceSync(text);
    }
    root.adoptedStyleSheets = [...new Set([...root.adoptedStyleSheets, sheets.get(text)])];
}

export function createShadow(host) {
    const root = host.attachShadow({ mode: 'open' });
    root.innerHTML = kMarkup;
    addStyles(root, styles);
    return root;
}

// A canvas in place of an older one, whose context is lost for good.
export function replaceCanvas(root, words) {
    const canvas = document.createElement('canvas');
    canvas.id = 'view';
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'application');
    canvas.setAttribute('aria-label', words('picture'));
    canvas.setAttribute('aria-describedby', 'help');
    root.getElementById('view')?.remove();
    root.getElementById('stage').prepend(canvas);
    return canvas;
}
