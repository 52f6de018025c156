// The first script of the page, which runs where others do not: says why they don't, and offers to try again.
(() => {
    const element = (id) => document.getElementById(id);
    const parsed = new Promise((done) => {
        document.addEventListener('DOMContentLoaded', done);
    });
    globalThis.sayFailure = async (text) => {
        await parsed;
        element('loading').hidden = true;
        element('message').textContent = text;
        element('message').hidden = element('retry').hidden = false;
    };
    parsed.then(() => {
        element('unstarted').hidden = true;
        element('retry').addEventListener('click', () => location.reload());
    });
    if (location.protocol === 'file:')
        globalThis.sayFailure(
            'Browsers do not load a room from a file. Open this page from a web server, ' +
                'e.g. that of: python3 -m http.server',
        );
    // Scripts that are missing or not allowed, whose events do not bubble, and such as cannot be parsed.
    addEventListener(
        'error',
        ({ target, message }) => {
            if (globalThis.viewerBegan || location.protocol === 'file:') return;
            const name = (target.src ?? target.href ?? '').split('/').pop();
            globalThis.sayFailure(
                name
                    ? `The page's file ${name} could not be loaded: it is missing on the server, or blocked.`
                    : `The page's script cannot run in this browser: ${message}`,
            );
        },
        true,
    );
})();
