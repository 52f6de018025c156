// What the page itself says, as long as the viewer does not: few words, in all languages.
const kTexts = {
    en: {
        loading: 'Loading',
        toCome: 'Reflections are still to come.',
        measuring: 'Measuring.',
        notMeasured: 'This device could not be measured: {cause}',
        retry: 'Retry',
        licence: 'Licence',
        others: 'Licences of others',
        fromFile:
            'Browsers do not load a room from a file. Open this page from a web server, ' +
            'e.g. that of: python3 -m http.server',
        missing: "The page's file {name} could not be loaded: it is missing on the server, or blocked.",
        cannotRun: "The page's script cannot run in this browser: {cause}",
    },
    de: {
        loading: 'Wird geladen',
        toCome: 'Die Spiegelungen folgen noch.',
        measuring: 'Messung läuft.',
        notMeasured: 'Dieses Gerät konnte nicht gemessen werden: {cause}',
        retry: 'Noch einmal',
        licence: 'Lizenz',
        others: 'Lizenzen anderer',
        fromFile:
            'Browser laden keine Räume aus Dateien. Öffnen Sie diese Seite von einem Webserver, ' +
            'z. B. dem von: python3 -m http.server',
        missing: 'Die Datei {name} der Seite konnte nicht geladen werden: sie fehlt auf dem Server oder ist gesperrt.',
        cannotRun: 'Das Skript der Seite läuft in diesem Browser nicht: {cause}',
    },
};

// ?lang=, else the browser's, if there are texts of it.
export function languageOf(search, own) {
    const asked = [new URLSearchParams(search).get('lang'), own].map((tag) => tag?.toLowerCase().split('-')[0]);
    return asked.find((tag) => Object.hasOwn(kTexts, tag)) ?? 'en';
}

export const textsOf = (language) => kTexts[language];
