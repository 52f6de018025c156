// The button that shows the room in a headset, where the browser knows one.

// `host`: see element.js; `say` tells visitors what fails.
export async function offerHeadset(host, button, { signal, say }) {
    const { viewer } = host,
        { xr } = navigator;
    // three.js's lights are as bright as they are in metres.
    if (!xr || !host.xr || viewer.navigation.meter !== 1) return;
    const isOffered = await xr.isSessionSupported('immersive-vr').catch(() => false);
    if (!isOffered || signal.aborted) return;
    const tell = (status) => {
        button.setAttribute('aria-pressed', status === 'session-started');
        host.dispatchEvent(new CustomEvent('xr-status', { detail: { status } }));
    };
    const enter = async () => {
        let session;
        try {
            // Asked for at once, while the browser knows of the press.
            const asked = xr.requestSession('immersive-vr', { requiredFeatures: ['local-floor'] });
            const [{ Headset }] = await Promise.all([import('./headset.js'), asked.then((value) => (session = value))]);
            if (viewer !== host.viewer) throw new Error('the room is gone');
            viewer.headset = new Headset(viewer, session, () => tell('not-presenting'));
            await viewer.headset.begin();
            tell('session-started');
        } catch (error) {
            console.warn(error);
            session?.end().catch(() => {});
            tell('failed');
            say(host.words('noHeadset'));
        }
    };
    button.hidden = false;
    button.addEventListener('click', () => (viewer.headset ? viewer.headset.leave() : enter()), { signal });
}
