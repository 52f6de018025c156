// The words of a viewer, in a language that it has: one file of this folder each. What a file leaves out is English.
import english from './en.js';

const others = { de: () => import('./de.js') };

// Resolves to a function of a string's name, and of what is filled in.
export async function wordsOf(language) {
    const load = others[language.toLowerCase().split('-')[0]],
        own = load ? (await load().catch(() => ({}))).default : {};
    const words = { ...english, ...own };
    return (name, values = {}) => words[name].replace(/\{(\w+)\}/g, (_, key) => values[key]);
}

// Fills in what the elements below `root` name: data-text is what they say, data-label what they are called.
export function translate(root, words) {
    for (const element of root.querySelectorAll('[data-text]')) element.textContent = words(element.dataset.text);
    for (const element of root.querySelectorAll('[data-label]')) {
        const label = words(element.dataset.label);
        element.setAttribute('aria-label', label);
        element.title = label;
    }
}
