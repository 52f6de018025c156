// The panel of the room's lamps, which is loaded when the settings are opened.

const kStatusMilliseconds = 300;

// `host`: see element.js.
export async function createLampPanel(host) {
    const { viewer, words } = host,
        { light } = viewer,
        element = (id) => host.find(id),
        controls = ['lamp', 'lit', 'brightness', 'lampcolor', 'relight'].map(element),
        [lamp, lit, brightness, color, relight] = controls;
    let lamps;
    try {
        lamps = await light.lights;
    } catch (error) {
        controls.forEach((control) => Object.assign(control, { disabled: true }));
        element('light').textContent = error.message;
        element('lamps').hidden = false;
        return;
    }
    lamp.append(...lamps.map(({ name }, i) => new Option(name || words('lampNumber', { number: i + 1 }), i)));
    const chosen = () => lamps[lamp.value];
    const show = () => {
        lit.checked = chosen().visible;
        brightness.value = chosen().intensity;
        color.value = `#${chosen().color.getHexString()}`;
    };
    const tell = () => {
        if (!element('light')) return; // the controls are gone
        element('light').textContent = light.isSettled ? (light.updates.failure?.message ?? '') : words('lightFollows');
        if (!light.isSettled) setTimeout(tell, kStatusMilliseconds);
    };
    const set = (name, value) => {
        chosen()[name] = value;
        viewer.changed();
        tell();
    };
    lamp.addEventListener('change', show);
    lit.addEventListener('change', () => set('visible', lit.checked));
    brightness.addEventListener('input', () => set('intensity', Number(brightness.value)));
    color.addEventListener('input', () => set('color', color.value));
    relight.addEventListener('click', () => {
        lamps.forEach((each) => each.reset());
        show();
        viewer.changed();
        tell();
    });
    if (lamps.length > 0) show();
    element('lamps').hidden = lamps.length === 0;
}
