// The first script of the page, which runs where others do not: says why they don't, and offers to try again. Then it
// joins the page to its viewer.
import { joinViewer } from './page.js';
import { languageOf, textsOf } from './strings/page.js';

const element = (id) => document.getElementById(id),
    language = languageOf(location.search, navigator.language),
    texts = textsOf(language);
const parsed = new Promise((done) => {
    document.addEventListener('readystatechange', done, { once: true });
});

async function sayFailure(text) {
    await parsed;
    element('loading').hidden = true;
    element('message').textContent = text;
    element('message').hidden = element('retry').hidden = false;
}

document.documentElement.lang = language;
// Before the viewer's script, which is deferred.
parsed.then(() => {
    element('unstarted').hidden = true;
    element('retry').textContent = texts.retry;
    element('retry').addEventListener('click', () => location.reload());
    const quality = new URLSearchParams(location.search).get('quality');
    if (quality) element('room').setAttribute('quality', quality);
    joinViewer(element('room'), texts, sayFailure);
});
if (location.protocol === 'file:') sayFailure(texts.fromFile);
// Scripts that are missing or not allowed, whose events do not bubble, and such as cannot be parsed.
addEventListener(
    'error',
    ({ target, message }) => {
        if (customElements.get('phat-viewer') || location.protocol === 'file:') return;
        const name = (target.src ?? target.href ?? '').split('/').pop();
        sayFailure(name ? texts.missing.replace('{name}', name) : texts.cannotRun.replace('{cause}', message));
    },
    true,
);
