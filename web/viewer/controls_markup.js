// The buttons in the picture and the settings. Words are filled in by translate().

const icon = (path) => `<svg viewBox="0 0 24 24" aria-hidden="true"><path d="${path}"/></svg>`;

const button = (id, label, path, more = '') =>
    `<button id="${id}" class="icon" type="button" data-label="${label}"${more}>${icon(path)}</button>`;

const field = (id, label, kind, more = '') =>
    `<label for="${id}" data-text="${label}"></label><input id="${id}" type="${kind}"${more}>`;

const select = (id, label, options = '') =>
    `<label for="${id}" data-text="${label}"></label><select id="${id}">${options}</select>`;

const qualities = ['fast', 'default', 'high'].map((name) => `<option value="${name}" data-text="${name}"></option>`).join('');

export const kIcons = {
    play: 'M8 5l11 7-11 7z',
    pause: 'M8 5v14M16 5v14',
};

export const kMarkup = `
<div id="border" role="slider" tabindex="0" aria-valuemin="0" aria-valuemax="100" data-label="wipeHandle" hidden></div>
<p id="toast" role="status"></p>
<div id="places" class="bar" role="group" data-label="viewpoint">
${button('previous', 'previous', 'M15 5l-7 7 7 7')}<select id="camera" data-label="viewpoint"></select>${button('next', 'next', 'M9 5l7 7-7 7')}${button('tour', 'tour', kIcons.play, ' aria-pressed="false"')}
</div>
<div id="tools" class="bar" role="group" data-label="view">
${button('orbit', 'orbit', 'M12 9a3 3 0 1 0 0 6 3 3 0 0 0 0-6M3 12c0-2.5 4-4.5 9-4.5s9 2 9 4.5-4 4.5-9 4.5M9 13.5l3 3-3 3', ' aria-pressed="false"')}${button('measure', 'tape', 'M3 16L16 3l5 5L8 21zM7 12l2 2M10 9l3 3M13 6l2 2', ' aria-pressed="false"')}${button('screenshot', 'screenshot', 'M4 8h3l2-3h6l2 3h3v11H4zM12 10a3 3 0 1 0 0 6 3 3 0 0 0 0-6')}${button('share', 'share', 'M10 14a4 4 0 0 0 6 0l3-3a4 4 0 0 0-6-6l-1 1M14 10a4 4 0 0 0-6 0l-3 3a4 4 0 0 0 6 6l1-1')}${button('headset', 'headset', 'M3 8h18v9h-6l-3-3-3 3H3zM7 12h2M15 12h2', ' aria-pressed="false" hidden')}${button('fullscreen', 'fullscreen', 'M4 9V4h5M20 9V4h-5M4 15v5h5M20 15v5h-5')}${button('settings', 'settings', 'M4 7h9M17 7h3M15 5v4M4 12h3M11 12h9M9 10v4M4 17h11M19 17h1M17 15v4', ' aria-expanded="false" aria-controls="panel"')}
</div>
<section id="panel" aria-labelledby="heading" hidden>
<header><h2 id="heading" data-text="settings"></h2>${button('close', 'close', 'M6 6l12 12M18 6L6 18')}</header>
<fieldset id="variants" hidden>
<legend data-text="variants"></legend>
<div id="swatches"></div>
</fieldset>
<fieldset id="materials">
<legend data-text="material"></legend>
${select('material', 'material')}${field('roughness', 'roughness', 'range', ' min="0" max="1" step="0.01"')}${field('metalness', 'metalness', 'range', ' min="0" max="1" step="0.01"')}${field('color', 'color', 'color')}
<button id="reset" type="button" data-text="reset"></button>
</fieldset>
<fieldset>
<legend data-text="pictureSettings"></legend>
${field('wipe', 'wipe', 'checkbox')}${field('exposure', 'exposure', 'range', ' min="-16" max="16" step="0.1"')}${select('quality', 'quality', qualities)}
</fieldset>
<fieldset id="motion" hidden>
<legend data-text="motion"></legend>
<button id="play" type="button" data-text="play"></button>
<p id="motionstate" role="status"></p>
</fieldset>
<fieldset id="lamps" hidden>
<legend data-text="lamps"></legend>
${select('lamp', 'lamp')}${field('lit', 'lit', 'checkbox')}${field('brightness', 'brightness', 'range', ' min="0" max="2" step="0.01"')}${field('lampcolor', 'color', 'color')}
<button id="relight" type="button" data-text="relight"></button>
<p id="light" role="status"></p>
</fieldset>
<p id="pointers"></p>
<p id="keys"></p>
<slot name="about"></slot>
</section>`;
