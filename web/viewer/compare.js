// A border in the picture, left of which all light is drawn, and right of it direct light alone.

const kKeyStep = 0.05;

export function offerComparison(host) {
    const { viewer } = host,
        [wipe, border] = ['wipe', 'border'].map((id) => host.find(id));
    const set = (part) => {
        viewer.light.wipe = Math.min(Math.max(part, 0), 1);
        border.style.left = `${100 * viewer.light.wipe}%`;
        border.setAttribute('aria-valuenow', Math.round(100 * viewer.light.wipe));
        viewer.changed();
    };
    const show = (isOn) => {
        border.hidden = !isOn;
        set(isOn ? 0.5 : 1);
    };
    wipe.checked = viewer.light.wipe < 1;
    border.hidden = !wipe.checked;
    if (wipe.checked) set(viewer.light.wipe);
    wipe.addEventListener('change', () => show(wipe.checked));
    border.addEventListener('pointerdown', ({ pointerId }) => border.setPointerCapture(pointerId));
    border.addEventListener('pointermove', ({ pointerId, clientX }) => {
        const { left, width } = host.getBoundingClientRect();
        if (border.hasPointerCapture(pointerId)) set((clientX - left) / width);
    });
    const steps = { ArrowLeft: -kKeyStep, ArrowRight: kKeyStep, Home: -1, End: 1 };
    border.addEventListener('keydown', (event) => {
        if (!(event.key in steps)) return;
        event.preventDefault();
        set(viewer.light.wipe + steps[event.key]);
    });
}
