// Joins the page of `phat web` to its viewer: progress, failures, measurements, and messages of a page that frames it.
import { answerMessages } from './messages.js';

const element = (id) => document.getElementById(id);

// With ?bench, once all is loaded.
async function showBench(room, texts) {
    element('status').textContent = texts.measuring;
    try {
        const text = JSON.stringify(await room.measure(location.search), null, 2);
        console.log(text);
        element('bench').textContent = text;
        element('bench').hidden = false;
    } catch (error) {
        element('message').textContent = texts.notMeasured.replace('{cause}', error.message);
        element('message').hidden = false;
        console.error(error);
    }
}

export function joinViewer(room, texts, sayFailure) {
    document.querySelectorAll('[data-text]').forEach((each) => {
        each.textContent = texts[each.dataset.text];
    });
    room.addEventListener('progress', async ({ detail: { totalProgress } }) => {
        element('progress').value = totalProgress;
        if (totalProgress < 1) return;
        if (new URLSearchParams(location.search).has('bench')) await showBench(room, texts);
        element('loading').hidden = true;
    });
    room.addEventListener('load', () => {
        globalThis.viewer = room.viewer; // for scripts
        element('status').textContent = texts.toCome;
    });
    room.addEventListener('error', ({ detail: { message } }) => sayFailure(message));
    if (parent !== window) answerMessages(room);
}
